"""`navbound live`: judge data that are still arriving. `session` has the commands of one source, `fleet` those of many aircraft."""

from navbound.cli.live.session import app

__all__ = ["app"]
