//! What the cycle sees of a device: ports, set-points, faults.
