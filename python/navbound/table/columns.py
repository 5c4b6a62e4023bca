"""Every column once: name, type, unit, meaning, the stage that adds it, and whether the report shows it.

What states a column reads this list: the tables of docs/notation.md, the types of the report's page (web/src/columns.gen.ts), the columns
that a report carries, the types and units of the Parquet files. A new column is one line here and `./dev generate`.
"""

from __future__ import annotations

from dataclasses import replace

from navbound.table.declare import Column, Drawn, Table, row

COVARIANCE = ("cov_ee_m2", "cov_en_m2", "cov_nn_m2", "cov_eu_m2", "cov_nu_m2", "cov_uu_m2")
"""The covariance of the navigation error, upper triangle."""
HORIZONTAL = COVARIANCE[:3]
"""Its horizontal part."""
VARIANCES = (COVARIANCE[0], COVARIANCE[2], COVARIANCE[5])
"""Its diagonal: east, north, up."""
METHOD_INPUTS = ("course_rad", "path_angle_rad", "fte_m", "fte_v_m", "rnp_m", *COVARIANCE)
"""Columns that the methods read (`navbound.methods.bounds`)."""

_EE = "*experimental, not integrity*"
_SEPARATION = "Filters with and without satellites"
_READ = "read, not written"

EPOCHS: tuple[Column, ...] = (
    *row("track", "which flight, approach or aircraft the epoch belongs to", "source", kind="text"),
    *row("time_ns", "GPS time since 1980-01-06 00:00:00", "source"),
    *row("est_lat_rad est_lon_rad est_h_m", "estimated position, WGS-84", "solution", shown=True),
    *row("truth_lat_rad truth_lon_rad truth_h_m", "true position, where it is known", "source"),
    *row("cov_ee_m2 cov_en_m2 cov_nn_m2", "covariance of the nse", "solution", shown=True),
    *row("cov_eu_m2 cov_nu_m2", "covariance of the nse", "solution"),
    *row("cov_uu_m2", "covariance of the nse", "solution", shown=True),
    *row("path_lat_rad path_lon_rad path_h_m", "the expected point on the path", "path", shown=True),
    *row("course_rad", "direction of the path there", "path", shown=True),
    *row("path_angle_rad", "direction of the path there", "path"),
    *row(
        "along_m",
        "distance along the path from its start (before the threshold it is negative on an approach)",
        "path",
        shown=True,
    ),
    *row("leg phase", "where in the flight", "path", kind="text", shown=True),
    *row("ground_speed_mps", "speed over the ground", "source", shown=True),
    *row("position_time_ns", f"GPS time at which a recorded position was valid, where the recording says so; {_READ}", "source"),
    *row(
        "ground_track_rad vertical_rate_mps",
        "direction of travel clockwise from true north, rate of climb, as a recording reports them",
        "source",
    ),
    *row("altitude_m", "altitude as a recording reports it: pressure altitude with ADS-B, not a height above the ellipsoid", "source"),
    *row("rnp_m", "RNP value in force", "path", shown=True),
    *row("fte_m fte_v_m", "flight technical error across and above the path, signed", "path", shown=True),
    *row("baro_off_m", "indicated altitude (pressure altitude with the altimeter setting) above the vertical path", "path", shown=True),
    *row("limit_v_m", "largest vertical deviation that the specification of a procedure allows", "path", shown=True),
    *row("nse_e_m nse_n_m nse_u_m", "navigation system error, where truth is known", "source", shown=True),
    *row("nse_along_m nse_cross_m", "the same along and across the course", "judge", shown=True),
    *row("nse_h_m nse_3d_m", "its horizontal and its three-dimensional length", "judge", shown=True),
    *row("tse_m tse_v_m", "total system error across and above the path, signed, where truth is known", "judge", shown=True),
    *row("stated_error_m", "the largest lateral or horizontal error that a row of a recording states itself", "source"),
    *row(
        "stated_worse_m",
        "the 95 % radius that a row of a recording states (EPU, standard deviations, the lower limit of a NACp or NUCp), where it is "
        "larger than the row's covariance allows",
        "source",
    ),
    *row(
        "stated_rc_m",
        "the containment radius that a row of a recording states (Rc, or that of its NIC or NUCp); infinite where it states that none is "
        "known",
        "source",
    ),
    *row("stated_alert", "the word of an alert that a row of a recording states itself; null where it states none", "source", kind="text"),
    *row("sigma_cross_m", "standard deviation of the nse across the course", "judge", shown=True),
    *row("<method>_m", "bound at the accuracy risk, `tse-exact` becoming `tse_exact_m`", "bound", shown=True),
    *row("<method>_integrity_m", "the same method at the integrity risk", "bound", shown=True),
    *row(
        "integrity_compared_m",
        "the larger of the judging method's integrity bound and |`fte_m`| + `hpl_m`: what the monitor compares with twice RNP, "
        "where there are protection levels",
        "judge",
        shown=True,
    ),
    *row("p_exceed_rnp p_exceed_2rnp", "risk that the lateral tse exceeds RNP and twice RNP", "judge", shown=True),
    *row(
        "status",
        "`ok`, `degraded`, `not_available`, `invalid_input`; in a recorded track the graver of the recorded one and ours",
        "judge",
        kind="text",
        shown=True,
    ),
    *row(
        "reason_id",
        "why, where the status is not `ok` or a level is missing: an id of `navbound.status.REASONS`; `reported` for a text of the input",
        "judge",
        kind="text",
    ),
    *row("reason", "the same as a sentence for people; nothing is decided by it", "judge", kind="text", shown=True),
    *row("excluded_sv", "satellites that a monitor on board excluded, `,` between them", "bound", kind="text"),
    *row(
        "nav_mode",
        "what keeps the position of a navigation filter: `gnss`, `dme_dme`, `vor_dme`, `coasting`, "
        "`aligning` (after a hole in the inertial samples), `stopped`",
        "solution",
        kind="text",
        shown=True,
    ),
    *row(
        "nav_source",
        "which position a navigation filter's epoch gives: `filter`, `snapshot` (the ranges of the instant alone), `none`",
        "solution",
        kind="text",
        shown=True,
    ),
    *row("nav_reasons", "ids of all reasons why that position is not `ok`, separated by spaces", "solution", kind="text", shown=True),
    *row("n_gated", "measurements that the filter's gate threw away in the last second", "solution", shown=True),
    *row(
        "separation_m",
        "horizontal distance between the navigation filters with and without satellites",
        "solution",
        shown=Drawn(_SEPARATION, "Distance"),
    ),
    *row(
        "separation_limit_m",
        "how far apart those filters may be where both are right",
        "solution",
        shown=Drawn(_SEPARATION, "Limit", limit=True),
    ),
    *row(
        "innovation_memory",
        "what the innovations of the ranges of the last minute remember of the ones before, in standard deviations",
        "solution",
        kind="number",
    ),
    *row(
        "innovation_range innovation_station innovation_baro",
        "largest innovation of the last second over the filter's gate, of ranges to satellites, of measurements of stations, of the "
        "altimeter; above 1 the measurement was thrown away",
        "solution",
        kind="number",
        shown=True,
    ),
    *row(
        "bias_gyro_x_radps bias_gyro_y_radps bias_gyro_z_radps bias_accel_x_mps2 bias_accel_y_mps2 bias_accel_z_mps2",
        "biases of the gyroscopes and the accelerometers as the filter estimates them, axes of the body",
        "solution",
        shown=True,
    ),
    *row(
        "sigma_bias_gyro_x_radps sigma_bias_gyro_y_radps sigma_bias_gyro_z_radps sigma_bias_accel_x_mps2 sigma_bias_accel_y_mps2 "
        "sigma_bias_accel_z_mps2",
        "their standard deviations",
        "solution",
        shown=True,
    ),
    *row("alert", "`normal`, `caution`, `warning`, `unavailable`", "judge", kind="text", shown=True),
    *row("state", "decided navigation specification, e.g. `RNP 0.3`, or `out of RNP`", "judge", kind="text", shown=True),
    *row("p_state_<i>", "probability of the i-th state, from 1", "judge", shown=True),
    *row("n_sv", "satellites in the solution", "solution", shown=True),
    *row("n_excluded n_redundant", "satellites excluded by the residual test; ranges beyond the unknowns", "solution"),
    *row("p_residual", "risk of residuals as large, if the errors are as the weights say", "solution"),
    *row("vel_e_mps vel_n_mps vel_u_mps", "velocity from Doppler", "solution"),
    *row(
        "hpl_m vpl_m",
        "horizontal and vertical protection level, computed, or as a receiver or solution file reports them",
        "bound",
        shown=True,
    ),
    *row("hel_m vel_m", "horizontal and vertical exclusion level: the largest level after the exclusion of any one satellite", "bound"),
    *row("hpl_slope_m vpl_slope_m", "published level of RAIM by slopes, without the noise of the position", "bound"),
    *row("decision", "what a test of residuals led to: `none`, `excluded`, `not_excluded`", "bound", kind="text"),
    *row("hpl_multi_m", "horizontal protection level against all faults together, where `hpl_m` is against one", "bound", shown=True),
    *row("hal_m", "horizontal alert limit in force", "path", shown=True),
    *row(
        "accuracy_m accuracy_limit_m",
        "horizontal accuracy (95 %) as a method states it, nominal biases included; what the sub-phase asks",
        "bound",
    ),
    *row(
        "hpl_e_m hpl_n_m",
        "east and north parts of a level worked out by axis; `hpl_m` is the root of the sum of their squares",
        "bound",
    ),
    *row("emt_m", "effective monitor threshold of ARAIM: the largest vertical detection threshold of a likely fault mode", "bound"),
    *row(
        "sigma_acc_e_m sigma_acc_n_m sigma_acc_u_m",
        "standard deviation of the position for accuracy, where that for integrity is another",
        "bound",
    ),
    *row(
        "n_modes n_monitored p_unmonitored",
        "fault modes, those that the geometry can monitor, and the probability of all that are not",
        "bound",
    ),
    *row("hdop vdop", "dilution of precision", "solution", kind="number", shown=True),
    *row("ee_error_e_m ee_error_n_m ee_error_u_m", f"error that Error Extraction splits off, east, north, up; {_EE}", "bound"),
    *row("ee_size_h_m ee_size_v_m", f"its size, horizontal and vertical, times beta; {_EE}", "bound"),
    *row("ee_sum_h_m ee_sum_v_m", f"weighted sum of the sizes over the window; {_EE}", "bound"),
    *row("ee_noise_h_m ee_noise_v_m", f"noise part of the EE bound; {_EE}", "bound"),
    *row("ee_bound_h_m ee_bound_v_m", f"EE bound; {_EE}: no protection level, and the monitor refuses it", "bound"),
    *row("n_ee_age", "samples since the filter of Error Extraction began anew; -1 without a solution", "bound"),
    *row("hpe_m vpe_m", "size of the horizontal and of the vertical nse, of its components where a table has them", "source"),
    *row(
        "mode",
        "what the protection level is for: `pa` precision approach, `npa` en route to non-precision approach; `raim`; `araim`; "
        "`gbas` with an inertial system, `rraim` a fix carried on by carrier phase",
        "bound",
        kind="text",
    ),
)
"""The epoch table."""

READ: tuple[Column, ...] = (
    *row("sigma_e_m sigma_n_m sigma_u_m", f"standard deviation of the position as a recording states it; {_READ}", "source"),
    *row("epu_m", f"95 % horizontal radius as a recording states it; {_READ}", "source"),
    *row(
        "unread_accuracy_m",
        "the largest number of columns that nothing reads though their names speak of a horizontal accuracy or error, read as metres "
        f"where their names state no unit; {_READ}",
        "source",
    ),
    *row(
        "unread_level_m",
        "the largest number of columns that nothing reads though their names speak of a horizontal protection level, read as metres "
        f"where their names state no unit; {_READ}",
        "source",
    ),
    *row("rc_m", f"horizontal containment radius that a transponder states; {_READ}", "source"),
    *row("setting_hpa", f"altimeter setting that an aircraft broadcasts; {_READ}", "source"),
    *row("nac_p nic", f"accuracy and integrity category that a transponder states; {_READ}", "source", kind="number"),
    *row("nuc_p", f"category of both that a transponder of version 0 states; {_READ}", "source", kind="number"),
    *row("pic", f"position integrity category of a surveillance report; {_READ}", "source", kind="number"),
    *row("callsign", f"callsign of the aircraft; {_READ}", "source", kind="text"),
)
"""What a recording may hold beside the columns of the epoch table."""

RANGES: tuple[Column, ...] = (
    *row("time_ns", "its epoch", "source"),
    *row("sv", "satellite, as `G05`", "source", kind="text"),
    *row("az_rad el_rad", "direction from the receiver, azimuth clockwise from true north", "solution"),
    *row(
        "sigma_m",
        "standard deviation of the range in the covariance: that of the model, widened where a failed test or the surroundings widen the "
        "covariance",
        "solution",
    ),
    *row("residual_m", "measured less computed range at the estimated position, receiver clock included", "solution"),
    *row("range_error_m", "the same at the true position", "source"),
    *row(
        "shared_1_m shared_2_m shared_3_m shared_4_m",
        "standard deviations of errors that all ranges have in common, signed: vertical ionosphere, its gradient east and north, "
        "zenith troposphere",
        "solution",
    ),
)
HEARD: tuple[Column, ...] = (
    *row("track", "whose receiver heard it", "source", kind="text"),
    *row("time_ns", "its epoch", "source"),
    *row("sv", "satellite, as `G05`", "source", kind="text"),
    *row(
        "fate",
        "what became of it: `used`, `excluded` by the residual test, or why it was not used: an id of `navbound.gnss.FATES`",
        "solution",
        kind="text",
    ),
    *row(
        "az_rad el_rad", "direction from the receiver, azimuth clockwise from true north; null without an orbit or a position", "solution"
    ),
    *row("cn0_dbhz", "carrier to noise density, where the receiver states it", "source"),
    *row(
        "residual_m",
        "of a range that was used, or that a monitor excluded: measured less computed at the position, by the clock of its constellation",
        "solution",
    ),
    *row("sigma_m", "its standard deviation in the covariance, for accuracy", "solution"),
)
SIGNALS: tuple[Column, ...] = (
    *row("signals", "what its ranges are made of, as `E1-E5a`", "source", kind="text"),
    *row("message", "navigation message of orbit and clock, as RINEX 4 names it", "source", kind="text"),
    *row("n_ranges", "ranges of all epochs, those below the mask and those of a constellation left out among them", "solution"),
)
SENSORS: tuple[Column, ...] = (
    *row("vel_d_mps", "true velocity downwards; with `vel_n_mps` and `vel_e_mps`", "source"),
    *row("roll_rad pitch_rad heading_rad", "true attitude", "source"),
    *row("force_x_mps2 force_y_mps2 force_z_mps2", "true specific force, body axes", "source"),
    *row("rate_x_radps rate_y_radps rate_z_radps", "true angular rate against inertial space, body axes", "source"),
    *row("interval_s", "length of the interval that ends at `time_ns`", "source"),
    *row("angle_x_rad angle_y_rad angle_z_rad", "integral of the measured angular rate over the interval", "source"),
    *row("velocity_x_mps velocity_y_mps velocity_z_mps", "integral of the measured specific force over the interval", "source"),
    *row("satellite", "which satellite, as RINEX names it", "source", kind="text"),
    *row("sv_x_m sv_y_m sv_z_m", "where it was at transmission, in the Earth-fixed axes of reception", "source"),
    *row("sv_vx_mps sv_vy_mps sv_vz_mps", "its velocity, likewise", "source"),
    *row("range_m", "code range, corrected for everything that is known", "source"),
    *row("range_rate_mps sigma_rate_mps", "range rate and its standard deviation", "source"),
    *row("phase_m sigma_phase_m", "accumulated carrier phase and its standard deviation", "source"),
    *row("sigma_white_m sigma_white_rad", "standard deviation of the part that is new with every measurement", "source"),
    *row("sigma_correlated_m correlation_time_s", "standard deviation of the part that stays, and for how long", "source"),
    *row("sigma_bias_m sigma_bias_rad", "standard deviation of a bias", "source"),
    *row("station", "which station", "source", kind="text"),
    *row("station_x_m station_y_m station_z_m", "where it is, Earth-fixed", "source"),
    *row("station_lat_rad station_lon_rad station_h_m", "where it is, WGS-84", "source"),
    *row("slant_m", "slant range to it", "source"),
    *row("bearing_rad", "direction from it to the aircraft, clockwise from true north", "source"),
    *row("baro_h_m", "height above the ellipsoid as the altimeter says it", "source"),
    *row("clock_m drift_mps", "true offset and drift of the satellite receiver's clock", "source"),
)
EVENTS: tuple[Column, ...] = (
    *row("track", "which flight, approach or aircraft", "source", kind="text"),
    *row("kind", "`caution`, `warning`, `unavailable`, `waypoint`, `phase`", "judge", kind="text"),
    *row("onset_ns annunciation_ns clear_ns", "begin, annunciation and end of the event", "judge"),
    *row("peak_m", "largest bound during the event", "judge"),
    *row("limit_m", "limit in force", "judge"),
    *row("min_margin_m", "smallest difference between limit and bound", "judge"),
    *row("words", "the event as a sentence for people", "judge", kind="text"),
)
LEVEL_EVENTS: tuple[Column, ...] = (
    *row("level", "service level", "summary", kind="text"),
    *row(
        "kind",
        "`loss` of availability, `hazard` (available, error beyond an alert limit), `mi` (error beyond its protection level)",
        "summary",
        kind="text",
    ),
    *row("onset_ns clear_ns", "begin and end of the event", "summary"),
    *row("n_epochs", "epochs of the event", "summary"),
    *row("duration_s", "its duration", "summary"),
    *row("over_tta", "whether it lasted longer than the time to alert", "summary", kind="flag"),
    *row("cause reason", "why: an id, and a sentence for people", "summary", kind="text"),
    *row("hpe_max_m vpe_max_m", "largest error during the event", "summary"),
    *row("hpl_max_m vpl_max_m", "largest protection level during the event", "summary"),
    *row("n_sv_before n_sv_onset", "satellites in the solution before and at the onset", "summary"),
    *row("mode_before mode_onset", "mode of the protection level before and at the onset", "summary", kind="text"),
)

_SCORE: tuple[Column, ...] = (
    *row("n_epochs", "epochs that were judged, one a second", "summary"),
    *row("nees", "mean of e' V^-1 e, 3 for a filter that is right", "summary", kind="number"),
    *row("p_circle p_sphere", "shares inside the 95 % circle and sphere", "summary"),
    *row("rms_e_m rms_n_m rms_u_m", "root mean square of the errors", "summary"),
    *row("sigma_e_m sigma_n_m sigma_u_m", "the same as the filter states it", "summary"),
    *row("p_coasting p_vor_dme p_dme_dme p_gnss p_aligning", "shares of the modes", "summary"),
    *row("n_stopped", "epochs after a stop", "summary"),
)
"""Of one filter."""
CONSISTENCY: tuple[Column, ...] = (
    *row("flight", "number of the flight", "summary", kind="count"),
    *_SCORE,
    *row(
        "range_mean_square range_lag_one",
        "mean square and correlation with the one before of the normalised innovations of the ranges",
        "summary",
        kind="number",
    ),
    *row("n_ranges_used n_ranges_gated", "ranges that the filter used, and that its gate threw away", "summary"),
    *row("range_memory_max", "largest memory of a minute of innovations, in standard deviations", "summary", kind="number"),
)
REVERSION: tuple[Column, ...] = (
    *row("n_compared", "instants at which the filters with and without satellites were compared", "summary"),
    *row(
        "separation_mean_square separation_max_square",
        "mean and largest square of their normalised horizontal difference; the mean is 2 where both are right",
        "summary",
        kind="number",
    ),
    *row("n_disagreements", "times that they were declared to disagree", "summary"),
    *(replace(column, name=f"reversion_{column.name}", meaning=f"{column.meaning}; of the filter without satellites") for column in _SCORE),
)
"""Only with a filter without satellites beside the main one."""
MAP_POINTS: tuple[Column, ...] = (
    *row("lat_rad lon_rad", "centre of the cell", "summary"),
    *row("p_available", "share of the epochs that meet every limit", "summary"),
    *row("n_sv_least", "the fewest satellites of any epoch", "summary"),
    *row("p_no_signal", "share of the epochs without a number because the SBAS satellite is too low", "summary"),
    *row("p_no_service", "the same because the service offers no usable satellite", "summary"),
    *row("p_too_few", "the same because of too few or badly placed satellites or stations", "summary"),
    *row("p_too_many", "the same because there are more than are worked out", "summary"),
    *row("p_not_monitored", "the same because faults that cannot be monitored take the whole risk", "summary"),
)
MAP_NUMBERS: tuple[Column, ...] = (
    *row("pdop hdop vdop gdop", "dilution of precision", "solution", kind="number"),
    *row("hpl_m vpl_m", "horizontal and vertical protection level", "bound"),
    *row("emt_m", "effective monitor threshold of ARAIM", "bound"),
    *row("nse_best_m nse_all_m", "95 % radius of the navigation error with the best pair of DMEs and with all of them", "bound"),
)
"""Numbers of every user and instant. A map of many epochs has their percentiles."""

TABLES = (
    Table("epochs", EPOCHS),
    Table("read", READ),
    Table("ranges", RANGES),
    Table("heard", HEARD),
    Table("signals", SIGNALS),
    Table("sensors", SENSORS),
    Table("events", EVENTS),
    Table("level-events", LEVEL_EVENTS),
    Table("consistency", (*CONSISTENCY, *REVERSION)),
    Table("map-points", MAP_POINTS),
    Table("map-numbers", MAP_NUMBERS),
)
"""Every table by the mark of its place in docs/notation.md."""
