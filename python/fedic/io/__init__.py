"""Reading images and meshes, and writing results."""
