"""Agents of one's own: loaded from files, sent to workers, never run stale."""

from arena.plugins.loading import PluginError, load_plugin

__all__ = ["PluginError", "load_plugin"]
