"""One sample call of every public function of the subject modules: two items each, for contracts over all of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import anp, araim, dme, evaluation, gbas, gnss, ins, kpi, path, raim, rnp, rraim, sbas, tse, vertical
from navbound.scenario.sensors import Imu

if TYPE_CHECKING:
    from collections.abc import Callable

_SUBJECTS = (tse, anp, rnp, gnss, sbas, raim, araim, gbas, rraim, dme, ins, kpi, evaluation, path, vertical)
MODULES = {m.__name__.rpartition(".")[2]: m for m in _SUBJECTS}


@dataclass(frozen=True)
class Call:
    """Arguments by name: numbers and arrays that a contract may change, and the rest."""

    function: Callable[..., Any]
    numbers: dict[str, Any]
    fixed: dict[str, Any] = field(default_factory=dict)
    made_of: Callable[..., Any] | None = None
    """The class whose parameters these are, where the function makes an object and uses it."""

    def __call__(self, **changed: Any) -> Any:
        return self.function(**{**self.numbers, **self.fixed, **changed})


TWO = np.array([1.0, 1.2])
EN = np.array([[[9.0, 1.0], [1.0, 4.0]], [[16.0, -2.0], [-2.0, 9.0]]])
ENU = np.array([[[9.0, 1.0, 0.5], [1.0, 4.0, 0.2], [0.5, 0.2, 16.0]]] * 2)
UP = np.array([[0.0, 0.6, 0.8], [0.6, 0.0, 0.8]])
AZ = np.radians([[0.0, 60.0, 120.0, 180.0, 240.0, 300.0, 20.0]] * 2)
EL = np.radians([[15.0, 35.0, 25.0, 55.0, 20.0, 40.0, 80.0]] * 2)
UNIT = np.stack([np.sin(AZ) * np.cos(EL), np.cos(AZ) * np.cos(EL), np.sin(EL)], axis=-1)
SYSTEM = [0] * 7
SIGMA = np.full((2, 7), 1.5)
RESIDUAL = np.array([[0.1, -0.2, 0.3, 0.0, -0.1, 0.2, -0.3]] * 2)
RISK = np.array([1e-5, 1e-5])
STATIONS = {"AAA": (0.70, 0.30, 100.0), "BBB": (0.71, 0.305, 200.0), "CCC": (0.705, 0.31, 150.0)}
ORBITS = gnss.constellation("gps")
TIME_NS = np.arange(2) * 1_000_000_000


UNIT_ERRORS = Imu.model_validate({name: 100.0 if name == "in_run_time_s" else 1e-5 for name in Imu.model_fields})


def _fte(**more: Any) -> dict[str, Any]:
    return {"fte_m": 30.0 * TWO, "sigma_m": 8.5 * TWO, **more}


def _plane(**more: Any) -> dict[str, Any]:
    return {"covariance_en_m2": EN, **more}


def _space(**more: Any) -> dict[str, Any]:
    return {"covariance_enu_m2": ENU, **more}


def _indicators(**columns: Any) -> Any:
    """The indicators of a table, a level with both axes."""
    return kpi.evaluate({"time_ns": TIME_NS, **columns}, "LPV-200")


def _hazard(**more: Any) -> dict[str, Any]:
    names = {"containment_m": 8.0, "sigma_tse_m": 1.0, "projection": 2.0, "allotted_risk": 1e-9, "p_fault": 1e-6, "bias_hor_m": 0.1}
    return {**{name: value * TWO for name, value in names.items()}, **more}


ENU_STATIONS = {"AAA": np.array([20e3, 0.0, 0.0]), "BBB": np.array([0.0, 30e3, 0.0]), "CCC": np.array([-25e3, 10e3, 0.0])}
OFFSET = np.array([[20.0, 5.0], [10.0, -7.0]])
OFFSET_3 = np.array([[20.0, 5.0, 3.0], [10.0, -7.0, 2.0]])
USERS = {"lat_rad": 0.7 * TWO, "lon_rad": 0.3 * TWO, "h_m": 100.0 * TWO}
SKY = {"az_rad": AZ, "el_rad": EL}

CALLS: dict[str, Call] = {
    "tse.box": Call(tse.box, _fte(fte_v_m=10.0 * TWO, sigma_v_m=4.0 * TWO, risk=RISK, correlation=0.1 * TWO, share=0.4 * TWO)),
    "tse.box_risk": Call(
        tse.box_risk, _fte(fte_v_m=10.0 * TWO, sigma_v_m=4.0 * TWO, limit_m=60.0 * TWO, limit_v_m=30.0 * TWO, correlation=0.1 * TWO)
    ),
    "tse.ctem": Call(tse.ctem, _plane(offset_en_m=OFFSET, risk=RISK)),
    "tse.ctem_foot": Call(tse.ctem_foot, _plane(fte_m=30.0 * TWO, course_rad=0.4 * TWO, risk=RISK)),
    "tse.exact": Call(tse.exact, _fte(risk=RISK)),
    "tse.exceedance_risk": Call(tse.exceedance_risk, _fte(limit_m=60.0 * TWO)),
    "tse.explain": Call(tse.explain, _plane(offset_en_m=OFFSET, course_rad=0.4 * TWO, risk=RISK)),
    "tse.factors": Call(tse.factors, {"risk": RISK}),
    "tse.fte_budget": Call(tse.fte_budget, {"limit_m": 60.0 * TWO, "sigma_m": 4.0 * TWO, "risk": RISK}),
    "tse.gradient": Call(tse.gradient, _fte(risk=RISK)),
    "tse.log_exceedance_risk": Call(tse.log_exceedance_risk, _fte(limit_m=60.0 * TWO)),
    "tse.ltem": Call(tse.ltem, _fte(risk=RISK)),
    "tse.ltem_as_printed": Call(tse.ltem_as_printed, _plane(offset_en_m=OFFSET, risk=RISK)),
    "tse.margin": Call(tse.margin, _fte(limit_m=160.0 * TWO, risk=RISK)),
    "tse.mixture": Call(
        tse.mixture,
        {"weight": np.array([[0.6, 0.4]] * 2), "fte_m": np.array([[10.0, 20.0]] * 2), "sigma_m": np.array([[3.0, 5.0]] * 2), "risk": RISK},
    ),
    "tse.paired_overbound": Call(tse.paired_overbound, _fte(bias_m=0.5 * TWO, risk=RISK)),
    "tse.project": Call(tse.project, _plane(offset_en_m=OFFSET, course_rad=0.4 * TWO)),
    "tse.random_fte": Call(
        tse.random_fte,
        {
            "mean_fte_m": 5.0 * TWO,
            "sigma_fte_m": 8.0 * TWO,
            "sigma_nse_m": 4.0 * TWO,
            "risk": RISK,
            "sigma_pde_m": 1.0 * TWO,
            "correlation": 0.1 * TWO,
        },
    ),
    "tse.rf_fte": Call(tse.rf_fte, {"fte_m": 30.0 * TWO, "along_m": 20.0 * TWO, "sigma_along_m": 5.0 * TWO, "radius_m": 4000.0 * TWO}),
    "tse.rotated_frame": Call(
        tse.rotated_frame,
        {"k": 0.5 * TWO, "x0_m": 3.0 * TWO, "y0_m": 20.0 * TWO, "sigma_a_m": 5.0 * TWO, "sigma_b_m": 3.0 * TWO, "risk": RISK},
    ),
    "tse.rssm": Call(
        tse.rssm,
        {"sigma_fte_m": 8.0 * TWO, "sigma_nse_m": 4.0 * TWO, "sigma_pde_m": 1.0 * TWO, "risk": RISK, "correlation": 0.1 * TWO},
    ),
    "tse.sigma_budget": Call(tse.sigma_budget, {"limit_m": 60.0 * TWO, "fte_m": 20.0 * TWO, "risk": RISK}),
    "tse.sqsm": Call(tse.sqsm, _plane(fte_m=30.0 * TWO, risk=RISK)),
    "tse.student_t": Call(tse.student_t, {"fte_m": 30.0 * TWO, "scale_m": 8.0 * TWO, "degrees_of_freedom": 6.0 * TWO, "risk": RISK}),
    "tse.vertical": Call(tse.vertical, _space(offset_enu_m=OFFSET_3, course_rad=0.4 * TWO, path_angle_rad=-0.05 * TWO, risk=RISK)),
    **{f"anp.{name}": Call(getattr(anp, name), _plane(risk=RISK)) for name in ("circle",)},
    **{
        f"anp.{name}": Call(getattr(anp, name), _plane(risk=np.array([0.05, 0.05])))
        for name in ("circle_fit", "circle_fit_as_printed", "circle_geodesy")
    },
    "anp.sphere_grubbs_as_printed": Call(anp.sphere_grubbs_as_printed, _space(risk=np.array([0.05, 0.05]))),
    **{f"anp.{name}": Call(getattr(anp, name), _plane()) for name in ("cep", "circle_major", "epu", "two_drms")},
    **{f"anp.{name}": Call(getattr(anp, name), _plane(radius_m=8.0 * TWO)) for name in ("circle_law", "circle_risk")},
    **{f"anp.{name}": Call(getattr(anp, name), _space(radius_m=9.0 * TWO)) for name in ("sphere_law", "sphere_risk")},
    **{
        f"anp.{name}": Call(getattr(anp, name), _space(direction=UP, risk=RISK))
        for name in ("along", "directional", "intercept", "marginal", "support")
    },
    **{
        f"anp.{name}": Call(getattr(anp, name), _space(risk=RISK))
        for name in ("box", "box_factor", "ellipsoid", "sphere", "sphere_grubbs", "volume_over_sphere")
    },
    **{
        f"anp.{name}": Call(getattr(anp, name), _space()) for name in ("sep_sum", "sphere_major", "sphere_mean_sigma", "sphere_rms", "vepu")
    },
    **{
        f"anp.{name}": Call(getattr(anp, name), _space(radius_m=9.0 * TWO, half_height_m=12.0 * TWO))
        for name in ("cylinder", "cylinder_risk")
    },
    "anp.cylinder_scale": Call(anp.cylinder_scale, _space(radius_m=9.0 * TWO, half_height_m=12.0 * TWO, risk=RISK)),
    **{
        f"anp.{name}": Call(getattr(anp, name), {"covariance_cu_m2": EN, "half_cross_m": 8.0 * TWO, "half_up_m": 9.0 * TWO})
        for name in ("rectangle", "rectangle_risk")
    },
    "anp.rectangle_scale": Call(
        anp.rectangle_scale, {"covariance_cu_m2": EN, "half_cross_m": 8.0 * TWO, "half_up_m": 9.0 * TWO, "risk": RISK}
    ),
    "anp.chi_factor": Call(anp.chi_factor, {"risk": RISK}, {"dimension": 2}),
    "anp.track": Call(anp.track, _space(course_rad=0.4 * TWO, risk=RISK)),
    "rnp.nse_boundary": Call(rnp.nse_boundary, {"tse_m": 555.0 * TWO, "fte_m": 100.0 * TWO}),
    "rnp.per_epoch_risk": Call(rnp.per_epoch_risk, {"risk_per_hour": 1e-7, "tau_s": 60.0, "sample_period_s": 1.0}),
    "rnp.per_hour_risk": Call(rnp.per_hour_risk, {"risk_per_epoch": 1e-7, "tau_s": 60.0, "sample_period_s": 1.0}),
    "rnp.specification": Call(rnp.specification, {"accuracy_m": 1000.0}, {"name": "RNP AR APCH", "phase": "missed"}),
    "rnp.state_of_error": Call(
        rnp.state_of_error, {"levels_nm": np.array([0.3, 1.0, 2.0]), "nse_m": 100.0 * TWO, "fte_nm": np.array([0.1, 0.1, 0.1])}
    ),
    "rnp.state_of_errors": Call(
        rnp.state_of_errors, {"levels_nm": np.array([0.3, 1.0, 2.0]), "lateral_m": 100.0 * TWO, "longitudinal_m": 50.0 * TWO}
    ),
    "rnp.states_of_track": Call(rnp.states_of_track, {"levels_nm": np.array([0.3, 1.0, 2.0]), "nse_m": 100.0 * TWO, "stay": 0.9}),
    "gnss.covariance": Call(gnss.covariance, {**SKY, "sigma_m": SIGMA}),
    "gnss.directions": Call(gnss.directions, {**USERS, "time_s": 100.0 * TWO}, {"orbits": ORBITS}),
    "gnss.dop": Call(gnss.dop, SKY),
    "gnss.dop_map": Call(gnss.dop_map, {**USERS, "time_s": 100.0 * TWO, "mask_rad": 0.1}, {"orbits": ORBITS}),
    "gnss.geodetic": Call(gnss.geodetic, {"ecef_m": np.array([[4.0e6, 1.0e6, 4.8e6]] * 2)}),
    "gnss.geometry": Call(gnss.geometry, {**USERS, "time_s": 100.0 * TWO, "mask_rad": 0.1}, {"orbits": ORBITS}),
    "gnss.nominal": Call(
        gnss.nominal,
        {
            "semi_major_m": 26_560_000.0 * np.ones(2),
            "inclination_rad": 0.96 * np.ones(2),
            "node_rad": TWO,
            "latitude_argument_rad": TWO,
            "eccentricity": 0.01 * TWO,
            "perigee_rad": TWO,
        },
    ),
    "gnss.places": Call(gnss.places, {**USERS, **SKY, "distance_m": 1000.0}),
    "gnss.responses": Call(gnss.responses, {**SKY, "sigma_m": SIGMA}),
    "sbas.covariance_levels": Call(sbas.covariance_levels, {"covariance_m2": np.array([[9.0, 1.0, 4.0, 0.5, 0.2, 16.0]] * 2)}),
    "sbas.extraction_beta": Call(sbas.extraction_beta, {"tau_s": 100.0 * TWO, "rho": np.array([0.98, 0.97]), "period_s": 1.0 * TWO}),
    "sbas.extraction_bias": Call(sbas.extraction_bias, {**SKY, "sigma_m": SIGMA, "mu_most_m": 1.125, "alpha": 1.1}),
    "sbas.extraction_bias_dop": Call(
        sbas.extraction_bias_dop, {"hdop": TWO, "vdop": 1.5 * TWO, "mu_most_m": 1.125, "alpha": 1.1}, {"n_sv": np.array([8, 9])}
    ),
    "sbas.extraction_factor": Call(sbas.extraction_factor, {"risk": 1e-7, "weight": 0.5}),
    "sbas.extraction_gains": Call(sbas.extraction_gains, {"rho": np.array([0.98, 0.97]), "period_s": 1.0 * TWO}),
    "raim.monitor": Call(raim.monitor, {"unit_enu": UNIT, "residual_m": RESIDUAL, "sigma_m": SIGMA}, {"constellation": SYSTEM}),
    "raim.protection_levels": Call(raim.protection_levels, {"unit_enu": UNIT, "sigma_m": SIGMA}, {"constellation": SYSTEM}),
    "raim.predict": Call(raim.predict, {**USERS, "time_s": 100.0 * TWO, "mask_rad": 0.1}, {"orbits": ORBITS}),
    "araim.monitor": Call(
        araim.monitor,
        {"unit_enu": UNIT, "residual_m": RESIDUAL, "sigma_int_m": SIGMA, "sigma_acc_m": SIGMA, "bias_m": 0.5 * SIGMA},
        {"constellation": SYSTEM},
    ),
    "araim.protection_levels": Call(
        araim.protection_levels,
        {"unit_enu": UNIT, "sigma_int_m": SIGMA, "sigma_acc_m": SIGMA, "bias_m": 0.5 * SIGMA},
        {"constellation": SYSTEM},
    ),
    "araim.predict": Call(araim.predict, {**USERS, "time_s": 100.0 * TWO, "mask_rad": 0.1}, {"orbits": ORBITS}),
    "gbas.accuracy_limit": Call(gbas.accuracy_limit, {"containment_m": 8.0}),
    "gbas.aided_covariance": Call(gbas.aided_covariance, {"az_rad": AZ[0], "el_rad": EL[0], "lat_rad": 0.7, "seconds": 60.0}),
    "gbas.bias_gain": Call(gbas.bias_gain, {"east_north": np.array([[0.3, 0.2], [-0.4, 0.1], [0.1, -0.3]])}),
    "gbas.carrier_sigma": Call(
        gbas.carrier_sigma,
        {"el_rad": 0.5 * TWO, "speed_mps": 10.0 * TWO, "coasting_s": 60.0 * TWO},
        {"carrier": next(iter(gbas.carriers().values()))},
    ),
    "gbas.factors": Call(gbas.factors, {"integrity_risk": 1e-9, "share": 0.25, "receiver_fault": 1e-5}),
    "gbas.fault_probability": Call(gbas.fault_probability, {"n_sv": 9.0 * np.ones(2), "rate_per_hour": 1e-5 * TWO, "tau_s": 100.0}),
    "gbas.missed_by_monitor": Call(gbas.missed_by_monitor, {"error_m": TWO, "stretch": 1.0}),
    "gbas.missed_detection_limit": Call(gbas.missed_detection_limit, _hazard(error_m=3.0 * TWO)),
    "gbas.monitor_margin": Call(gbas.monitor_margin, _hazard(stretch=1.0), {"service": "D"}),
    "gbas.offset_variances": Call(gbas.offset_variances, {"true_constant_s": 100.0, "shortest_s": 54.0, "longest_s": 2894.0}),
    "gbas.protection_levels": Call(gbas.protection_levels, {**SKY, "sigma_m": 0.3 * SIGMA, "sigma_h1_m": 0.4 * SIGMA, "bias_m": 0.1 * TWO}),
    "gbas.range_sigma": Call(gbas.range_sigma, {"el_rad": 0.5 * TWO}),
    "rraim.protection_levels": Call(
        rraim.protection_levels,
        {**SKY, "az_now_rad": AZ, "el_now_rad": EL, "sigma_td_m": 0.1 * SIGMA, "sigma_m": 0.3 * SIGMA, "sigma_h1_m": 0.4 * SIGMA},
    ),
    "dme.icao_two_sigma": Call(dme.icao_two_sigma, {"slant_1_m": 50e3 * TWO, "slant_2_m": 60e3 * TWO, "inclusion_rad": 1.2 * TWO}),
    "dme.range_sigma": Call(dme.range_sigma, {"slant_m": 50e3 * TWO}),
    "dme.vor_dme": Call(
        dme.vor_dme, {"ground_m": 50e3 * TWO, "slant_m": 51e3 * TWO, "sigma_vor_rad": 0.03 * TWO, "sigma_dme_m": 200.0 * TWO}
    ),
    "dme.sights": Call(dme.sights, {**USERS, "h_m": 5000.0 * TWO}, {"stations": STATIONS}),
    "dme.coverage": Call(
        dme.coverage,
        {
            "lat_rad": np.array([0.703, 0.704]),
            "lon_rad": np.array([0.303, 0.304]),
            "h_m": 5000.0 * TWO,
            "rnp_m": 1852.0,
            "fte_m": 500.0,
            "sigma_altitude_m": 30.0,
            "risk": 0.05,
        },
        {"stations": STATIONS},
    ),
    "dme.pair": Call(
        dme.pair,
        {
            "aircraft_enu_m": np.array([0.0, 0.0, 5000.0]),
            "first_enu_m": np.array([20e3, 0.0, 0.0]),
            "second_enu_m": np.array([0.0, 30e3, 0.0]),
            "sigma_altitude_m": 30.0,
        },
    ),
    "dme.best_pair": Call(
        dme.best_pair, {"aircraft_enu_m": np.array([0.0, 0.0, 5000.0]), "sigma_altitude_m": 30.0}, {"stations_enu_m": ENU_STATIONS}
    ),
    "dme.pairs": Call(
        dme.pairs, {"aircraft_enu_m": np.array([0.0, 0.0, 5000.0]), "sigma_altitude_m": 30.0}, {"stations_enu_m": ENU_STATIONS}
    ),
    "dme.solve": Call(
        dme.solve,
        {
            "slant_m": np.array([[29e3, 45e3, 52e3]] * 2),
            "h_m": np.full(2, 5000.0),
            "sigma_altitude_m": 30.0,
            "sigma_m": np.full((2, 3), 200.0),
            "prior_lat_rad": np.full(2, 0.703),
            "prior_lon_rad": np.full(2, 0.303),
            "prior_within_m": 60e3,
            "residual_risk": 1e-3,
        },
        {"stations": STATIONS},
    ),
    "dme.solve_vor": Call(
        dme.solve_vor,
        {
            "slant_m": np.full(2, 30e3),
            "bearing_rad": TWO,
            "station_rad_m": np.array([0.7, 0.3, 100.0]),
            "h_m": np.full(2, 5000.0),
            "sigma_altitude_m": 30.0,
            "sigma_bearing_rad": 0.04,
        },
    ),
    "sbas.extraction_beta_from_autocorrelation": Call(
        sbas.extraction_beta_from_autocorrelation, {"autocorrelation_m2": np.exp(-np.arange(4000) / 100.0), "rho": 0.98}
    ),
    "raim.factors": Call(raim.factors, {"n_redundant": np.array([1, 2])}),
    "kpi.stanford": Call(kpi.stanford, {"error_m": 3.0 * TWO, "level_m": 20.0 * TWO, "alert_limit_m": 40.0}),
    "kpi.rnp": Call(kpi.rnp, {"rnp_nm": 0.3, "tta_s": 10.0}),
    "evaluation.bound": Call(evaluation.bound, {"error_m": 3.0 * TWO, "bound_m": 20.0 * TWO, "risk": 0.05}),
    "evaluation.containment": Call(evaluation.containment, {"n_effective": 10.0, "risk": 0.05}, {"n_outside": 3, "n": 100}),
    "evaluation.crps": Call(evaluation.crps, {"error_m": 3.0 * TWO, "sigma_m": 2.0 * TWO}),
    "evaluation.bootstrap_coverage": Call(
        evaluation.bootstrap_coverage, {"error_m": 3.0 * TWO, "bound_m": 3.3 * TWO[::-1]}, {"track": [0, 1], "n_replicates": 100}
    ),
    "evaluation.effective_size": Call(evaluation.effective_size, {"values": np.array([1.0, -0.4, 0.7, 0.2, -0.9, 0.3])}),
    "evaluation.magnitude": Call(evaluation.magnitude, {"error_m": np.array([[5.0, 1.0], [2.0, -3.0]]), "covariance_m2": EN}),
    "evaluation.nees": Call(evaluation.nees, {"error_m": np.array([[5.0, 1.0], [2.0, -3.0]]), "covariance_m2": EN}),
    "evaluation.pit": Call(evaluation.pit, {"error_m": np.array([[5.0, 1.0], [2.0, -3.0]]), "covariance_m2": EN}),
    "ins.coarse_attitude": Call(
        ins.coarse_attitude, {"force_mps2": np.array([0.1, 0.2, -9.8]), "velocity_ned_mps": np.array([3.0, 4.0, 0.1])}
    ),
    "ins.roll": Call(
        ins.roll,
        {"position": np.column_stack([0.7 + 1e-6 * np.arange(12), np.full(12, 0.3), np.full(12, 100.0)]), "truth_interval_s": 1.0},
        {"start_ns": 0, "unit": UNIT_ERRORS},
    ),
    "dme.select": Call(
        dme.select,
        {
            **{"lat_rad": np.array([0.703, 0.7032]), "lon_rad": np.array([0.3, 0.3001]), "h_m": 5000.0 * TWO, "course_rad": 0.3 * TWO},
            **{"sigma_altitude_m": 30.0, "sigma_bearing_rad": 0.04},
        },
        {"time_ns": TIME_NS, "stations": STATIONS},
    ),
    "sbas.error_extraction": Call(
        sbas.error_extraction,
        {
            **{"position_enu_m": np.array([[0.1, 0.2, 0.3], [0.4, 0.1, 0.2]]), "velocity_enu_mps": np.array([[0.1, 0.2, 0.1]] * 2)},
            **{"bias_h_m": TWO, "bias_v_m": 2.0 * TWO, "rho": 0.98, "weight": 0.5, "beta": 1.2, "risk_h": 1e-9, "risk_v": 5e-8},
            **{"period_s": 1.0, "gap_most_s": 3.0},
        },
        {"time_ns": TIME_NS, "window": 2},
    ),
    "sbas.levels_from_terms": Call(
        sbas.levels_from_terms,
        {
            **{"az_rad": AZ[0], "el_rad": EL[0], "x_pp": np.full(7, 0.4), "y_pp": np.full(7, 0.3), "delta_udre": 1.1, "fast_mps2": 1e-4},
            **{"fast_age_s": 6.0, "latency_s": 1.0, "e_rrc_m": 0.1, "e_ltc_m": 0.2, "e_er_m": 0.1, "iono_step_m": 0.1},
            **{"iono_interval_s": 60.0, "iono_ramp_mps": 1e-4, "iono_age_s": 100.0, "noise_m": 0.36, "divergence_m": 0.1},
        },
        {"udrei": np.full(7, 5), "givei": np.full((7, 4), 6)},
    ),
    "sbas.extraction_beta_from_spectrum": Call(
        sbas.extraction_beta_from_spectrum,
        {
            **{"frequency_hz": np.linspace(0.0, 0.5, 200), "density_m2_per_hz": 1.0 / (0.01 + np.linspace(0.0, 0.5, 200) ** 2)},
            **{"rho": 0.98, "period_s": 1.0},
        },
    ),
    "kpi.evaluate": Call(_indicators, {"hpl_m": 20.0 * TWO, "vpl_m": 25.0 * TWO, "nse_e_m": 3.0 * TWO}),
    "kpi.continuity": Call(kpi.continuity, {"available": np.array([1.0, 1.0, 0.0, 1.0])}, {"n_window_epochs": 2}),
    "path.line": Call(path.line, {"lat0_rad": 0.7, "lon0_rad": 0.3, "lat1_rad": 0.71, "lon1_rad": 0.31}),
    "path.from_azimuth": Call(path.from_azimuth, {"lat_rad": 0.7, "lon_rad": 0.3, "course_rad": 0.4}),
    "path.route": Call(path.route, {"lat_rad": np.array([0.7, 0.71]), "lon_rad": np.array([0.3, 0.31])}),
}

_AIR = {"station_m": 500.0 * TWO, "deviation_k": -20.0 * TWO}
_SLOPE = {"crossing_m": 100.0 * TWO, "angle_rad": 0.05 * TWO}
_PLACE = {"rnp_m": 300.0 * TWO, "angle_rad": 0.05 * TWO, "altitude_m": 900.0 * TWO}
CALLS |= {
    "vertical.area_setting": Call(
        vertical.area_setting,
        {
            "intercept_m": 25.0,
            "others_m": np.array([20.0, 24.0, 22.0, 21.0]),
            "distance_m": np.array([9e3, 8e3, 7e3, 6e3]),
            "apart_s": np.array([60.0, -60.0, 30.0, 90.0]),
        },
    ),
    "vertical.barometric_altitude": Call(vertical.barometric_altitude, {"distance_m": 9000.0 * TWO, **_SLOPE}),
    "vertical.barometric_distance": Call(vertical.barometric_distance, {"altitude_m": 900.0 * TWO, **_SLOPE}),
    "vertical.budget": Call(
        vertical.budget, {**_PLACE, "threshold_m": 300.0 * TWO, "isad_m": -20.0 * TWO, "body_geometry_m": 7.6 * TWO}, {"constants": "feet"}
    ),
    "vertical.cold_correction": Call(vertical.cold_correction, {"true_m": 300.0 * TWO, **_AIR}),
    "vertical.cold_correction_doc8168": Call(vertical.cold_correction_doc8168, {"height_m": 300.0 * TWO, **_AIR}),
    "vertical.indicated_height": Call(vertical.indicated_height, {"true_m": 300.0 * TWO, **_AIR}),
    "vertical.isa_deviation": Call(vertical.isa_deviation, {"station_m": 500.0 * TWO, "temperature_k": 240.0 * TWO}),
    "vertical.obstacle_surface": Call(
        vertical.obstacle_surface,
        {
            "rnp_m": 300.0,
            "angle_rad": 0.05,
            "fix_altitude_m": 900.0,
            "threshold_m": 300.0,
            "crossing_height_m": 15.0,
            "temperature_k": 260.0,
        },
        {"constants": "feet"},
    ),
    "vertical.off_path_sigma": Call(
        vertical.off_path_sigma,
        {"sigma_along_m": 20.0 * TWO, "sigma_up_m": 8.0 * TWO, "correlation": 0.2 * TWO, "angle_rad": 0.05 * TWO},
    ),
    "vertical.requirement": Call(vertical.requirement, _PLACE, {"constants": "feet"}),
    "vertical.risk_below": Call(vertical.risk_below, {"fte_m": 3.0 * TWO, "sigma_m": 8.0 * TWO, "limit_m": 22.86 * TWO}),
    "vertical.setting_error": Call(vertical.setting_error, {"qnh_hpa": 950.0 * TWO, "setting_hpa": 960.0 * TWO}),
    "vertical.setting_line": Call(
        vertical.setting_line, {"height_m": np.array([0.0, 300.0, 900.0]), "difference_m": np.array([5.0, 1.0, 2.0])}
    ),
    "vertical.setting_offset": Call(vertical.setting_offset, {"setting_hpa": 950.0 * TWO}),
    "vertical.setting_test": Call(
        vertical.setting_test,
        {"sigma_m": 10.0 * TWO, "false_alarm": 1e-3 * TWO, "error_m": 50.0 * TWO, "probability": 0.8 * TWO},
    ),
    "vertical.straight_altitude": Call(vertical.straight_altitude, {"distance_m": 9000.0 * TWO, **_SLOPE}),
    "vertical.true_height": Call(vertical.true_height, {"indicated_m": 300.0 * TWO, **_AIR}),
    "vertical.turn_geometry": Call(vertical.turn_geometry, {"semispan_m": 20.0 * TWO, "bank_rad": 0.3 * TWO}),
}

WITHOUT: dict[str, str] = {
    **dict.fromkeys(
        (
            "gnss.read_navigation",
            "gnss.read_observations",
            "gnss.read_orbits",
            "gnss.constellation",
            "sbas.read",
            "sbas.decode",
            "dme.read_stations",
            "path.procedure",
        ),
        "reads a file: damaged numbers are tested with the formats",
    ),
    **dict.fromkeys(
        ("gnss.solve", "sbas.solve", "sbas.protection_levels", "sbas.satellites", "raim.watch", "araim.watch"),
        "its numbers come from files; its settings are checked in the tests of its module",
    ),
    **dict.fromkeys(
        ("ins.fuse", "ins.mechanize", "ins.simulate", "ins.consistency"),
        "a stream of samples: what is refused is counted (tests of the filter)",
    ),
    **dict.fromkeys(
        ("kpi.stanford_esa", "kpi.with_subsets", "kpi.level", "kpi.levels"),
        "takes or gives records, or a name; its tables are those of kpi.evaluate",
    ),
    **dict.fromkeys(
        (
            "gbas.allocation",
            "gbas.carriers",
            "gbas.error_budget",
            "gbas.fault_rates",
            "gbas.inertial",
            "gbas.model_marks",
            "gbas.monitor_curves",
            "gbas.multipath_times",
            "gbas.sub_phases",
            "rnp.specifications",
        ),
        "a table without arguments",
    ),
}
"""Public functions without a sample, with the reason."""
