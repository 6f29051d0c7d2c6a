"""The same walkers drawn by other programs, each a script for a Python that has that program, or for Node.

    python raylib_crowd.py WALKER.glb PLACES.json FRAMES
    python panda3d_crowd.py WALKER.glb PLACES.json FRAMES
    node three_crowd.mjs WALKER.glb PLACES.json FRAMES

Each prints one line of JSON per crowd. They need a display (Xvfb will do).
"""
