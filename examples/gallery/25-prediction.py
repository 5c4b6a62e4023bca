"""A planned flight whose satellites are jammed for twenty minutes: DME keeps the RNP, without a protection level."""

import tempfile
from pathlib import Path

from navbound import plot
from navbound.run.expected.flight import predict_flight

plan = Path(tempfile.mkdtemp()) / "plan.toml"
plan.write_text('title = "jammed"\nflight = "beijing-shanghai"\n[[jamming]]\nfrom_min = 40\nuntil_min = 60\n', encoding="utf-8")
ax = plot.prediction(predict_flight(plan, with_hold=False))
