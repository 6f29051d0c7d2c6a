"""Turns a scene (plain values) into pixels with moderngl; knows no trial, clock or file of a run."""
