"""A satellite's range jumps, later another one drifts away, while the aircraft navigates by satellites and inertial sensors. Who notices?

Expected output:

    satellite-step gate after 2 s; no alert needed; largest horizontal error 3 m
    satellite-ramp gate after 2 s; no alert needed; largest horizontal error 3 m
    bound within RNP at 100 % of the ok epochs; on one flight alone: not_shown
"""

import navbound

run = navbound.fly("beijing-shanghai-satellite-wrong")
for fault in run.summary.faults:
    print(f"{fault.kind:14} gate after {fault.gate_after_s:.0f} s; {fault.outcome}; largest horizontal error {fault.nse_h_max_m:.0f} m")
verdict = run.summary.verdict
print(f"bound within RNP at {100 * verdict.share_inside:g} % of the ok epochs; on one flight alone: {verdict.id}")
