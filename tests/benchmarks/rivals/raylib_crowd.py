"""raylib by its Python bindings: one clip per walker, GPU skinning, one draw call each, one directional light."""

from __future__ import annotations

import ctypes
import json
import time

import raylib
from frames import AIM, EYE, FIELD_OF_VIEW, RATE, SIZE, arguments, timed
from raylib import ffi

VERTEX = b"""#version 330
in vec3 vertexPosition; in vec3 vertexNormal; in vec4 vertexBoneIndices; in vec4 vertexBoneWeights;
uniform mat4 boneMatrices[32]; uniform mat4 mvp; uniform mat4 matNormal;
out vec3 normal;
void main() {
    mat4 skin = mat4(0.0);
    for (int i = 0; i < 4; i++) skin += vertexBoneWeights[i] * boneMatrices[int(vertexBoneIndices[i])];
    normal = mat3(matNormal) * (mat3(skin) * vertexNormal);
    gl_Position = mvp * (skin * vec4(vertexPosition, 1.0));
}
"""
FRAGMENT = b"""#version 330
in vec3 normal; uniform vec4 colDiffuse; out vec4 pixel;
void main() {
    pixel = vec4(colDiffuse.rgb * (0.35 + 0.65 * max(dot(normalize(normal), vec3(0.4, 0.75, 0.53)), 0.0)), 1.0);
}
"""


def main() -> None:
    """Times every crowd."""
    glb, crowds, frames = arguments()
    raylib.SetTraceLogLevel(5)
    raylib.SetConfigFlags(raylib.FLAG_WINDOW_HIDDEN)
    raylib.InitWindow(*SIZE, b"rival")
    finish = ctypes.CDLL("libGL.so.1").glFinish
    model = raylib.LoadModel(glb.encode())
    count = ffi.new("int *")
    clips = raylib.LoadModelAnimations(glb.encode(), count)
    shader = raylib.LoadShaderFromMemory(VERTEX, FRAGMENT)
    for material in range(model.materialCount):
        model.materials[material].shader = shader
    target = raylib.LoadRenderTexture(*SIZE)
    camera = ffi.new("struct Camera3D *")
    camera.position, camera.target, camera.up = list(EYE), list(AIM), [0, 1, 0]
    camera.fovy, camera.projection = FIELD_OF_VIEW, 0
    last = clips[0].keyframeCount - 1
    triangles = sum(model.meshes[i].triangleCount for i in range(model.meshCount))
    for size, walkers in crowds.items():

        def frame(number: int, walkers: list[tuple[float, float, float]] = walkers) -> float:
            posing = 0.0
            raylib.BeginTextureMode(target)
            raylib.ClearBackground([150, 150, 150, 255])
            raylib.BeginMode3D(camera[0])
            for x, z, phase in walkers:
                begun = time.perf_counter()
                raylib.UpdateModelAnimation(model, clips[0], (phase + number / RATE) % 1.0 * last)
                posing += time.perf_counter() - begun
                raylib.DrawModel(model, [x, 0.0, z], 1.0, [200, 150, 120, 255])
            raylib.EndMode3D()
            raylib.EndTextureMode()
            finish()
            return posing

        print(json.dumps({"walkers": size, "triangles": triangles, **timed(frame, frames)}), flush=True)
    raylib.ExportImage(raylib.LoadImageFromTexture(target.texture), b"/tmp/rival-raylib.png")
    raylib.CloseWindow()


if __name__ == "__main__":
    main()
