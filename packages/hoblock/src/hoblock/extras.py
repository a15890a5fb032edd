"""Import of optional packages, with the command that installs them when they are missing."""

from __future__ import annotations

import importlib
from types import ModuleType

from hoblock.errors import MissingExtraError

__all__ = ["import_extra"]


def import_extra(module: str, extra: str, package: str = "hoblock") -> ModuleType:
    """Import a module that only an extra of a package brings.

    Parameters
    ----------
    module : str
        Dotted name of the module, for example ``"matplotlib.pyplot"``.
    extra : str
        Name of the extra, for example ``"plot"``.
    package : str, optional
        Distribution that offers the extra.

    Returns
    -------
    ModuleType
        The imported module (the last part of a dotted name).

    Raises
    ------
    MissingExtraError
        If the module, or its parent package, is not installed. An installed module that fails to import
        something else raises what it raises.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        parents = {module.rsplit(".", depth)[0] for depth in range(module.count(".") + 1)}
        if error.name not in parents:
            raise
        raise MissingExtraError(
            f"the module {module!r} is not installed, and this feature needs it. "
            f"Install it with: pip install '{package}[{extra}]'",
            module=module,
            extra=extra,
        ) from error
