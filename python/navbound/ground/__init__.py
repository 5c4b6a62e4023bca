"""A landing and the taxi-in: motion, satellites, GBAS with an inertial system, then carrier phase, second by second."""
