"""The generator of gaitlab's default bodies: run at release time, never while an experiment runs.

python -m stimuli.body_generator woman --out woman.glb
"""
