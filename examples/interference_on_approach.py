"""When does the monitor speak, if interference makes the position worse on the approach to Shanghai?

Expected output:

    warning  from 01:53:05 UTC: bound up to 1959 m against 1111 m
    caution  from 01:53:05 UTC: bound up to 1026 m against 556 m
    inside RNP at 96.9 % of the epochs
"""

import navbound
from navbound.run.verdict.results import share
from navbound.time import utc_text

run = navbound.fly("beijing-shanghai-degraded")
for event in run.summary.events:
    print(f"{event.kind:8} from {utc_text(event.onset_ns)[11:]} UTC: bound up to {event.peak_m:.0f} m against {event.limit_m:.0f} m")
print(f"inside RNP at {share(run.summary.verdict.share_inside)} of the epochs")
