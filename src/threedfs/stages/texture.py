"""The surface with photographs on it, for viewers and other programs."""

from __future__ import annotations

from pathlib import Path

from threedfs.errors import UserError
from threedfs.io.crops import read_crops
from threedfs.io.keyframes import read_views
from threedfs.io.meshes import read_mesh
from threedfs.io.texture import TextureRecord, write_texture
from threedfs.io.textured_meshes import write_textured_glb, write_textured_obj
from threedfs.io.volumes import read_support
from threedfs.job import Job
from threedfs.object.stand import stand_up, turn_y_up
from threedfs.params.rules import make_rule
from threedfs.params.texture import TextureParams
from threedfs.texture.held_out import hold_out, spread_views
from threedfs.texture.paint import PaintRule, paint_mesh
from threedfs.texture.simplify import simplify_mesh
from threedfs.texture.textured import TexturedMesh


def run(
    *,
    mesh: Path,
    support: Path,
    keyframes: Path,
    crops: Path,
    glb: Path,
    textured: Path,
    method: str,
    params: TextureParams,
    job: Job,
) -> None:
    """Simplify the mesh, paint it from the crops, write it as GLB, upright, and as OBJ in the world of the mesh.

    Not in the paper. Some photographs are left out, for the figures that compare them with pictures of the painted
    mesh; painted.json beside the OBJ names them.

    Raises
    ------
    UserError
        If no photograph is left to paint from.
    """
    full, images = read_mesh(mesh), read_crops(crops)
    simple = simplify_mesh(full, params.tolerance) if params.tolerance else full
    if simple is None:
        job.progress.note(f"{mesh} is not closed, so its texture has all of its faces")
        simple = full
    views = read_views(keyframes)
    names = [name for name in images.names if name in views]
    held = hold_out(names, params.held_out_step)
    painters = spread_views([views[name] for name in names if name not in held], params.views)
    if not painters:
        raise UserError(
            f"{crops}: expected photographs to paint the mesh from, found {len(names)}, of which {len(held)} are held "
            "out; raise texture.held_out_step, or set it to 0."
        )
    painting = paint_mesh(simple, painters, images.image, images.valid_of, make_rule(PaintRule, params))
    painted = painting.textured
    write_textured_obj(textured / "mesh.obj", painted)
    upright = turn_y_up(stand_up(painted.mesh, read_support(support).plane))
    write_textured_glb(glb, TexturedMesh(upright, painted.corners, painted.image))
    record = TextureRecord([view.name for view in painters], held, painting.charts, painting.unseen_share)
    write_texture(textured / "painted.json", record, job.header)
    job.progress.note(
        f"{method}: {len(simple.faces)} triangles for {len(full.faces)}, {painting.charts} charts, "
        f"{painting.unseen_share:.0%} of the area in no photograph"
    )
