"""Meshes and their topology: elements, blocks, faces, edges and what touches what."""
