//! Where the aircraft should be: geodesic legs, fly-by turns and centrelines on the WGS-84 ellipsoid.
