"""One flight from Beijing to Shanghai with drawn errors, four bounds of its error at 95 %: how large are they, and do they hold?

Expected output:

    tse_exact        13.3 m on average, holds the error at 98.5 % of 7081 epochs
    tse_ltem         13.7 m on average, holds the error at 99.4 % of 7081 epochs
    tse_ctem_foot    13.7 m on average, holds the error at 99.4 % of 7081 epochs
    tse_sqsm         13.9 m on average, holds the error at 99.6 % of 7081 epochs
"""

import numpy as np

import navbound

epochs = navbound.fly("beijing-shanghai-drawn").epochs
error_m = np.abs(epochs["tse_m"].to_numpy())
for method in ("tse_exact", "tse_ltem", "tse_ctem_foot", "tse_sqsm"):
    bound_m = epochs[f"{method}_m"].to_numpy()
    inside = np.mean(error_m <= bound_m)
    print(f"{method:14} {bound_m.mean():6.1f} m on average, holds the error at {100 * inside:.1f} % of {len(error_m)} epochs")
