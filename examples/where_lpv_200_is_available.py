"""Where in Europe does ARAIM with GPS and Galileo give LPV-200 over a day, and what if two satellites are out of service?

Expected output:

    all satellites: 100.0 % of the area for 95 % of the time, 96.2 % of the area for 99 % of the time
    without G05 and E11: 100.0 % of the area for 95 % of the time, 94.9 % of the area for 99 % of the time
"""

from navbound import maps
from navbound.maps.sources import Times

europe = maps.Grid.degrees(5.0, (35.0, 70.0, -10.0, 40.0))
hourly = Times(step_s=3600.0)
for out in ((), ("G05", "E11")):
    summary = maps.make("araim", grid=europe, times=hourly, without=out).summary
    shares = ", ".join(f"{100 * c.share:.1f} % of the area for {100 * c.available:g} % of the time" for c in summary.coverage[:2])
    print(f"{'without ' + ' and '.join(out) if out else 'all satellites'}: {shares}")
