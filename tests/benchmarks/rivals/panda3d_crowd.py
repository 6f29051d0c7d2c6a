"""Panda3D: one Actor per walker with one clip, skinned on the GPU, one directional light."""

from __future__ import annotations

import json
import time

from frames import AIM, EYE, FIELD_OF_VIEW, RATE, SIZE, arguments, timed
from panda3d.core import Filename, Shader, loadPrcFileData

loadPrcFileData(
    "",
    f"window-type offscreen\nwin-size {SIZE[0]} {SIZE[1]}\ngl-version 3 3\ngl-finish 1\nsync-video 0\nmultisamples 0\n"
    "audio-library-name null\nhardware-animated-vertices 1\nnotify-level-display error\nmodel-cache-dir\n",
)
import gltf  # noqa: E402, F401
from direct.actor.Actor import Actor  # noqa: E402
from direct.showbase.ShowBase import ShowBase  # noqa: E402

VERTEX = """#version 330
uniform mat4 p3d_ModelViewProjectionMatrix; uniform mat3 p3d_NormalMatrix; uniform mat4 p3d_TransformTable[32];
in vec4 p3d_Vertex; in vec3 p3d_Normal; in vec4 transform_weight; in uvec4 transform_index;
out vec3 normal;
void main() {
    mat4 skin = mat4(0.0);
    for (int i = 0; i < 4; i++) skin += transform_weight[i] * p3d_TransformTable[transform_index[i]];
    normal = p3d_NormalMatrix * (mat3(skin) * p3d_Normal);
    gl_Position = p3d_ModelViewProjectionMatrix * (skin * p3d_Vertex);
}
"""
FRAGMENT = """#version 330
in vec3 normal; out vec4 pixel;
void main() {
    pixel = vec4(vec3(0.78, 0.59, 0.47) * (0.35 + 0.65 * max(dot(normalize(normal), vec3(0.4, 0.53, 0.75)), 0.0)), 1.0);
}
"""


def main() -> None:
    """Times every crowd."""
    glb, crowds, frames = arguments()
    app = ShowBase(windowType="offscreen")
    app.setBackgroundColor(0.59, 0.59, 0.59)
    app.camLens.setAspectRatio(SIZE[0] / SIZE[1])
    app.camLens.setMinFov(FIELD_OF_VIEW)
    app.camLens.setNearFar(0.1, 400.0)
    app.cam.setPos(EYE[0], -EYE[2], EYE[1])
    app.cam.lookAt(AIM[0], -AIM[2], AIM[1])
    shader = Shader.make(Shader.SL_GLSL, VERTEX, FRAGMENT)
    base = Actor(Filename.fromOsSpecific(glb))
    name = sorted(base.getAnimNames())[0]
    triangles = sum(
        geom.getPrimitive(i).getNumPrimitives()
        for path in base.findAllMatches("**/+GeomNode")
        for geom in path.node().getGeoms()
        for i in range(geom.getNumPrimitives())
    )
    for size, walkers in crowds.items():
        root = app.render.attachNewNode("crowd")
        root.setShader(shader)
        actors = []
        for x, z, _ in walkers:
            actor = Actor(other=base)
            actor.reparentTo(root)
            actor.setPos(x, -z, 0.0)
            actors.append(actor)
        controls = [
            (actor, actor.getAnimControl(name), phase) for actor, (_, _, phase) in zip(actors, walkers, strict=True)
        ]
        last = controls[0][1].getNumFrames() - 1

        def frame(number: int, controls: list = controls, last: int = last) -> float:
            begun = time.perf_counter()
            for actor, control, phase in controls:
                control.pose((phase + number / RATE) % 1.0 * last)
                actor.update(0)
            posing = time.perf_counter() - begun
            app.graphicsEngine.renderFrame()
            return posing

        print(json.dumps({"walkers": size, "triangles": triangles, **timed(frame, frames)}), flush=True)
        if size < max(crowds):
            for actor in actors:
                actor.cleanup()
                actor.removeNode()
            root.removeNode()
    app.win.saveScreenshot(Filename("/tmp/rival-panda3d.png"))


if __name__ == "__main__":
    main()
