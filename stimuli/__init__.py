"""Captured motion, gait cycles, blend trees and bodies: everything that makes a walker, without a window."""
