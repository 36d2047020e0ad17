"""All effects there are: every file beside this one that has an ``EFFECT``."""

import pkgutil
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from types import MappingProxyType

import arm.effects
from arm.effects.effect import EffectKind


@cache
def catalogue() -> Mapping[str, EffectKind]:
    """Return the effects by name, in the order of their names."""
    modules = (import_module(f"arm.effects.{found.name}") for found in pkgutil.iter_modules(arm.effects.__path__))
    kinds = [module.EFFECT for module in modules if hasattr(module, "EFFECT")]
    return MappingProxyType({kind.name: kind for kind in sorted(kinds, key=lambda kind: kind.name)})
