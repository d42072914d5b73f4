//! Events on the path of a motion, timed by the arm: the device function `path_event`.

use crate::catalogue::devices::function;
use crate::macros::interface;
use crate::operand::Text;
use crate::registry::Prim;

pub(in crate::catalogue) const ALL: &[Prim] = &[PATH_EVENT];

interface! {
    /// Reports when the motion with the number `inMotion` passes a place on its path. Call it after the motion primitive, in
    /// each cycle. The place is `inOffset` (m; rad for a motion of the axes) plus the share `inShare` (0 to 1) of the path
    /// behind an origin. `inOrigin` is 0 for the start of the path, 1 for its end, 2 for the point with the index
    /// `inPoint` (from 0; of a spline, or the middle of a rounded corner), and 3 and 4 for the beginning and the end of the
    /// rounded corner with this index. `outPassed` is true once the place has been passed. `outTime` is the time from the
    /// passage to the set-point of this cycle, in s: exact in the cycle in which `outPassed` becomes true. Before, it is
    /// minus the time until the passage as planned now, minus infinity if that is unknown. While `inPending` is true,
    /// the arm reports the event as missed if the motion ends or another one takes over. `outError` is the error code for a
    /// place that is not on the path or a motion that is not the present one, 0 if there is none.
    PATH_EVENT = "Rpi::PathEvent";
    in {
        inMotion: i64;
        inOrigin: i64 = Origin(Int(0));
        inPoint: i64 = Point(Int(0));
        inOffset: f64 = Offset(Real(0.0));
        inShare: f64 = Share(Real(0.0));
        inPending: bool = Pending(Bool(true))
    }
    param { Robot: Text = Str("") }
    out {
        outPassed: bool;
        outTime: f64;
        outError: i64
    }
    presence strict work 2000;
    role function("Robot", &["path_event"])
}
