"""Decode the working frames of a video or a folder of photos."""

from __future__ import annotations

from pathlib import Path

from threedfs.frames.decode import FrameReader, check_enough, choose_step, scan_source
from threedfs.frames.masks import check_mask_sizes, find_masks
from threedfs.frames.true_masks import check_true_masks
from threedfs.io.frames import write_frames
from threedfs.job import Job
from threedfs.params.frames import FramesParams
from threedfs.read_ahead import read_ahead


def run(*, source: Path, masks: Path | None, frames: Path, params: FramesParams, job: Job) -> None:
    """Read the source; write frames.zarr.zip, streamed.

    Raises
    ------
    UserError
        If the source is missing, is neither video nor photos or has too few usable frames, or if a mask has the
        wrong size, cannot be a mask, or none belongs to a frame.
    """
    scanned = scan_source(source, job.progress)
    annotated = {} if masks is None else find_masks(masks, scanned.names, numbered=scanned.ordered)
    check_mask_sizes(annotated, scanned.shape)
    check_true_masks(annotated.values(), str(masks))
    reader = FrameReader(
        scanned,
        job.progress,
        longest_side=params.longest_side,
        step=choose_step(len(scanned.names), params.max_frames),
        keep=annotated,
        blank_contrast=params.blank_contrast,
    )

    def checked():
        yield from reader
        check_enough(reader, params.min_frames)

    write_frames(
        frames,
        read_ahead(checked(), threads=job.threads),
        job.header,
        ordered=scanned.ordered,
        source_shape=scanned.shape,
        skipped=lambda: reader.skipped,
    )
    job.progress.note(
        f"{reader.taken} of {len(scanned.names) + scanned.unreadable} frames taken, {len(annotated)} with a mask; "
        f"{reader.blank} blank, {reader.skipped} not decodable"
    )
