"""An hour of a receiver that hears MSAS: do its protection levels hold, and is APV-I there?

Give it observations, navigation data and messages, and the receiver's true place. The output is that of the real messages of 2025-02-15
and a simulated receiver with noise only: its levels are real, its errors mean nothing.

    python examples/an_hour_of_sbas.py user.25O.gz gps.nav msas137.ems -3962108.2258 3381309.0271 3668678.5241

Expected output:

    3457 of 3600 epochs have a position, 3457 meet the limits of APV-I
    h: error 95 % 0.4 m, protection level 95 % 14.2 m, above it 0 times
    v: error 95 % 3.1 m, protection level 95 % 31.0 m, above it 0 times
    vertical Stanford diagram: 3457 nominal, 0 misleading, 0 hazardous
"""

import sys

from navbound import gnss, kpi, sbas

observations, navigation, messages, *truth_ecef_m = sys.argv[1:]
solved = sbas.solve(
    gnss.read_observations(observations),
    gnss.read_navigation(navigation),
    sbas.read(messages),
    mode="pa",
    truth_ecef_m=[float(metres) for metres in truth_ecef_m],
)
performance = kpi.evaluate(solved.epochs, ["APV-I"])
level = performance.levels[0]
print(
    f"{performance.n_solution} of {performance.n_expected} epochs have a position, {level.n_available} meet the limits of {level.level.id}"
)
for axis in performance.axes:
    print(f"{axis.axis}: error 95 % {axis.error_m.p95:.1f} m, protection level 95 % {axis.level_m.p95:.1f} m, above it {axis.n_mi} times")
regions = kpi.stanford(solved.epochs["nse_u_m"], solved.epochs["vpl_m"], 50.0).counts
print(f"vertical Stanford diagram: {regions.n_nominal} nominal, {regions.n_mi} misleading, {regions.n_hmi} hazardous")
