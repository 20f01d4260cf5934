"""Weights that the paper's author published, as a policy: `python -m graphdrl.published IN.pt -o OUT.safetensors`.

Needs PyTorch 1.13 or later, which the rest of the package does not. Weights that anybody trained with that code convert
as well.
"""

from __future__ import annotations

import argparse
import os
import pathlib
from collections.abc import Sequence

from ._core import Error
from .checks import path_text, shown
from .policies import PaperNetwork

__all__ = ["read_published"]


def read_published(path: str | os.PathLike[str]) -> PaperNetwork:
    """The network of a `state_dict()` that the author's code saved. No code in the file is executed.

    It sees the wall as that code does, and its values are those before that code's `log_softmax`: the order is the
    same, and so is every walk.

    Args:
        path: the file.

    Raises:
        Error: any other file.
        ImportError: no PyTorch.
    """
    import torch

    file = path_text(path)
    try:
        with open(file, "rb") as stream:
            state = torch.load(stream, map_location="cpu", weights_only=True)
    except OSError as error:
        raise Error(f"{file}: cannot read: {error.strerror}") from error
    except Exception as error:  # whatever the unpickler meets in a damaged file
        raise Error(f"{file}: not a PyTorch file with tensors alone, or a damaged one") from error
    if not isinstance(state, dict):
        raise Error(f"{file}: expected a state dict, got {shown(type(state).__name__)}")
    tensors = {}
    for name, value in state.items():
        if not (torch.is_tensor(value) and value.layout == torch.strided):
            raise Error(f"{file}: bad tensor {shown(name)}: expected numbers, got {shown(type(value).__name__)}")
        if str(name).endswith(".num_batches_tracked"):  # counts batches; no value depends on it
            continue
        # Later versions of PyTorch Geometric wrap batch normalisation: bn1.module.weight for bn1.weight.
        tensors[str(name).replace(".module.", ".")] = value.detach().float().numpy()
    try:
        return PaperNetwork(tensors, pathlib.Path(file).stem, wall="zero_or_nine")
    except Error as error:
        raise Error(f"{file}: {error}") from error


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> None:
        self.exit(2, f"{self.prog}: {message}\n")


def main(arguments: Sequence[str] | None = None) -> None:
    """The command. Exits with status 2 and one line where the caller must change something."""
    parser = _Parser(
        prog="graphdrl.published", description="Convert weights of the paper's author to a policy file.",
    )
    parser.add_argument("weights", metavar="IN.pt", help="a state dict that the author's code saved")
    parser.add_argument("-o", "--out", metavar="OUT.safetensors", required=True, help="the policy file to write")
    options = parser.parse_args(arguments)
    try:
        read_published(options.weights).save(options.out)
    except ImportError:
        parser.error("PyTorch is missing: expected a Python that can import torch")
    except Error as error:
        parser.error(str(error))


if __name__ == "__main__":
    main()
