"""Scenes that several tests render: their textures, meshes and cameras."""
