"""Writes frames as an MP4 file (H.264) through PyAV."""

from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path
from typing import Any

from roadgpt.errors import RoadGPTError, UsageError, explained, to_install
from roadgpt.report.film.glyphs import Frame
from roadgpt.run.atomic import whole_file

ENCODER = "libx264"
QUALITY, PRESET = 20, "veryfast"  # x264's scale, on which smaller is better


def encoder() -> Any:
    """Returns the module ``av`` (PyAV).

    Raises:
        UsageError: PyAV is not installed, or was built without its H.264 encoder.
    """
    try:
        import av
    except ImportError as error:
        raise UsageError(f"films need PyAV; say {to_install('film')}") from error
    if ENCODER not in av.codecs_available:
        raise UsageError(
            f"PyAV is installed without {ENCODER}, which writes films; install it from its wheels: "
            "python -m pip install --force-reinstall --only-binary av av"
        )
    return av


def write_film(frames: Iterable[Frame], path: Path, fps: int, about: str = "") -> None:
    """Writes frames into a file with the title ``about``; the file appears only when it is complete. The
    width and height of the frames must be even numbers of pixels.

    Raises:
        UsageError: as for ``encoder``.
        RoadGPTError: the file cannot be written.
    """
    av = encoder()
    with explained(RoadGPTError, f"cannot write {path}", "name another --out"):
        path.parent.mkdir(parents=True, exist_ok=True)
        with (
            whole_file(path) as draft,
            av.open(str(draft), "w", format="mp4", options={"movflags": "+faststart"}) as file,
        ):
            file.metadata["title"] = about
            _encode(av, file, frames, fps)


def _encode(av: Any, file: Any, frames: Iterable[Frame], fps: int) -> None:
    stream = None
    for n, frame in enumerate(frames):
        if stream is None:
            options = {"crf": str(QUALITY), "preset": PRESET}
            stream = file.add_stream(ENCODER, rate=fps, options=options)
            stream.height, stream.width = frame.shape[:2]
            stream.pix_fmt = "yuv420p"
        picture = av.VideoFrame.from_ndarray(frame, format="rgb24")
        picture.pts, picture.time_base = n, Fraction(1, fps)
        file.mux(stream.encode(picture))
    if stream is not None:
        file.mux(stream.encode(None))
