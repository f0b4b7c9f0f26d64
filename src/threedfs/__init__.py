"""From a handheld video to the mesh of its object (3DFS, Gupta et al. 2016)."""
