"""Meshes and their topology: elements, blocks, faces, edges and contacts between them."""
