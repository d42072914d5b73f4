//! Kinematics of serial arms: chains by Denavit-Hartenberg tables, forward and analytic inverse.
