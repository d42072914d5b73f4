//! Motions of an arm, planned by the arm: the device functions `move_line`, `move_joints` and others.

use crate::aggregates::Array;
use crate::catalogue::devices::function;
use crate::macros::interface;
use crate::operand::Text;
use crate::registry::Prim;
use crate::value_types::{Pose, Vector};
use rpi_image::ShapeRule;

pub(in crate::catalogue) const ALL: &[Prim] = &[
    MOVE_LINE,
    MOVE_ARC,
    MOVE_ARC_BY_CENTRE,
    MOVE_ARC_BY_ANGLE,
    MOVE_CORNER,
    MOVE_SPLINE,
    MOVE_JOINTS,
    MOVE_AXES,
    FOLLOW_JOINTS,
    MOVE_AT_VELOCITY,
    HOLD,
    MOVE_TOOL_IN_BASE,
    MOVE_TOOL_IN_TOOL,
    FOLLOW_CHUNKS,
    FOLLOW_POSE_CHUNKS,
    FOLLOW_POSE,
];

/// Declares a motion primitive: a call of a function of the arm in each cycle. Its declared work of 20000 elementary
/// operations covers the planning that the arm does in a cycle, about 200 µs. `out` declares further out-ports, together
/// with the work.
macro_rules! motion {
    (
        $(#[doc = $doc:expr])+
        $id:ident = $name:literal, $port:literal;
        in { $($target:tt)* }
        $( param $axes:ident; )?
        shape $shape:expr
    ) => {
        motion! {
            $(#[doc = $doc])+
            $id = $name, $port;
            in { $($target)* }
            $( param $axes; )?
            out {}
            work 20000;
            shape $shape
        }
    };
    (
        $(#[doc = $doc:expr])+
        $id:ident = $name:literal, $port:literal;
        in { $( $target:ident : $ty:ty $( = $need:tt $( ( $($def:tt)+ ) )? )? );* }
        $( param $axes:ident; )?
        out { $( $extra:ident : $extra_ty:ty );* }
        work $work:literal;
        shape $shape:expr
    ) => {
        interface! {
            $(#[doc = $doc])+
            ///
            /// The motion begins in a cycle in which `inMotion` is 0, from the position, velocity and acceleration of
            /// the arm as commanded. `outMotion` is the number of the motion; pass it to `inMotion` in the next cycles.
            /// The other in-ports are read only at the beginning, except `inOverride` (share of the speed, 0 to 1),
            /// `inPaused` (the arm comes to rest on the path) and those described above as read in each cycle. The frame that
            /// is called tool here is `inTool`, a pose in the frame of the arm's own tool. A part
            /// of the initial velocity and acceleration of the arm that the path does not have decays within the limits
            /// of all axes; `outOnPath` is true afterwards. `outDone` is true from the cycle after the last set-point.
            /// `outError` is the error code of the motion once the arm rests; 0 if there is none.
            $id = $name;
            in {
                inMotion: i64;
                $( $target: $ty $( = $need $( ( $($def)+ ) )? )?; )*
                inSpeed: f64 = Speed(Real(0.25));
                inAcceleration: f64 = Acceleration(Real(0.5));
                inJerk: f64 = Jerk(Real(5.0));
                inOverride: f64 = Override(Real(1.0));
                inPaused: bool = Paused(Bool(false));
                inTool: Pose
            }
            param { Robot: Text = Str("") $(; $axes: i64 = Int(7))? }
            out {
                outMotion: i64;
                outJoints: Array<f64>;
                outPose: Pose;
                outTravelled: f64;
                outProgress: f64;
                outSpeed: f64;
                outOnPath: bool;
                outDone: bool;
                outError: i64
                $( ; $extra: $extra_ty )*
            }
            shape $shape;
            presence strict work $work;
            role function("Robot", &[$port])
        }
    };
}

motion! {
    /// Straight line of the tool from its present pose to `inTo`, in the base frame of the arm. The tool turns in
    /// proportion to the distance. Units are m and s. `Axes` is the number of axes of the arm.
    MOVE_LINE = "Rpi::MoveLine", "move_line";
    in { inTo: Pose }
    param Axes;
    shape ShapeRule::FromParam("Axes")
}

motion! {
    /// Circular arc of the tool from its present pose through the position of `inVia` to `inTo`, in the base frame of
    /// the arm. The tool turns in proportion to the distance. Units are m and s. `Axes` is the number of axes of the
    /// arm.
    MOVE_ARC = "Rpi::MoveArc", "move_arc";
    in { inVia: Pose; inTo: Pose }
    param Axes;
    shape ShapeRule::FromParam("Axes")
}

motion! {
    /// Circular arc of the tool from its present pose to `inTo`, about `inCentre` (the shorter way round), in the base
    /// frame of the arm. The tool turns in proportion to the distance. Units are m and s. `Axes` is the number of axes
    /// of the arm.
    MOVE_ARC_BY_CENTRE = "Rpi::MoveArcByCentre", "move_arc_by_centre";
    in { inCentre: Vector; inTo: Pose }
    param Axes;
    shape ShapeRule::FromParam("Axes")
}

motion! {
    /// Circular arc of the tool from its present pose by `inAngle` (rad, any number of turns) about the axis `inAxis`
    /// through `inCentre`, in the base frame of the arm. The tool turns with the arc if `inTurning` is true, else it
    /// keeps its orientation. Units are m and s. `Axes` is the number of axes of the arm.
    MOVE_ARC_BY_ANGLE = "Rpi::MoveArcByAngle", "move_arc_by_angle";
    in { inCentre: Vector; inAxis: Vector; inAngle: f64; inTurning: bool }
    param Axes;
    shape ShapeRule::FromParam("Axes")
}

motion! {
    /// Two straight lines of the tool, from its present pose to `inVia` and on to `inTo`, in the base frame of the arm.
    /// The corner between them is rounded at most `inZone` before and after `inVia`. Units are m and s. `Axes` is the
    /// number of axes of the arm.
    MOVE_CORNER = "Rpi::MoveCorner", "move_corner";
    in { inVia: Pose; inTo: Pose; inZone: f64 }
    param Axes;
    shape ShapeRule::FromParam("Axes")
}

motion! {
    /// Smooth curve of the tool from its present pose through `inPoints`, at most 16, in the base frame of the arm.
    /// Curvature and angular acceleration are continuous. Units are m and s. `Axes` is the number of axes of the arm.
    MOVE_SPLINE = "Rpi::MoveSpline", "move_spline";
    in { inPoints: Array<Pose> }
    param Axes;
    shape ShapeRule::FromParam("Axes")
}

motion! {
    /// Straight line in joint space to `inTo`: all axes arrive together. Speed, acceleration and jerk are those of the
    /// axis that moves farthest, in rad (m for a linear axis) and s.
    MOVE_JOINTS = "Rpi::MoveJoints", "move_joints";
    in { inTo: Array<f64> }
    shape ShapeRule::SameAsInput(1)
}

motion! {
    /// Motion of the axes to `inTo`: each has a profile of its own, and all arrive at the same time (synchronised by time).
    /// Speed, acceleration and jerk are those of each axis, in rad (m for a linear axis) and s.
    MOVE_AXES = "Rpi::MoveAxes", "move_axes";
    in { inTo: Array<f64> }
    shape ShapeRule::SameAsInput(1)
}

motion! {
    /// Motion of the axes to a goal that is at `inTo` and moves with `inVelocity`; both are read in each cycle. Each axis goes
    /// there as fast as it can; `outDone` is true while all are at the goal. A goal beyond the range of an axis is followed
    /// to the end of the range. Speed, acceleration and jerk are those of each axis, in rad (m for a linear axis) and s.
    FOLLOW_JOINTS = "Rpi::FollowJoints", "follow_joints";
    in { inTo: Array<f64>; inVelocity: Array<f64> }
    shape ShapeRule::SameAsInput(1)
}

motion! {
    /// Motion of the axes with the velocities `inVelocity`, which are read in each cycle; `outDone` is true while all have
    /// them. The motion stops with an error where an axis comes to the end of its range. Acceleration and jerk are those of
    /// each axis, in rad (m for a linear axis) and s.
    MOVE_AT_VELOCITY = "Rpi::MoveAtVelocity", "move_at_velocity";
    in { inVelocity: Array<f64> }
    shape ShapeRule::SameAsInput(1)
}

motion! {
    /// Brings all axes to rest, as fast as their limits allow, and holds them; `outDone` is true while they rest. `Axes` is
    /// the number of axes of the arm.
    HOLD = "Rpi::Hold", "hold";
    in { }
    param Axes;
    shape ShapeRule::FromParam("Axes")
}

motion! {
    /// Motion of the tool with the velocities `inLinear` (m/s) and `inAngular` (rad/s) in the frame of the base, which are
    /// read in each cycle; `inSpeed` bounds them. The motion stops with an error where the arm cannot go on: an axis at the
    /// end of its range, a singularity, the end of the reach. `Axes` is the number of axes of the arm.
    MOVE_TOOL_IN_BASE = "Rpi::MoveToolInBase", "move_tool_in_base";
    in { inLinear: Vector; inAngular: Vector }
    param Axes;
    shape ShapeRule::FromParam("Axes")
}

motion! {
    /// Motion of the tool with the velocities `inLinear` (m/s) and `inAngular` (rad/s) in the frame of the tool, which are
    /// read in each cycle; `inSpeed` bounds them. The motion stops with an error where the arm cannot go on: an axis at the
    /// end of its range, a singularity, the end of the reach. `Axes` is the number of axes of the arm.
    MOVE_TOOL_IN_TOOL = "Rpi::MoveToolInTool", "move_tool_in_tool";
    in { inLinear: Vector; inAngular: Vector }
    param Axes;
    shape ShapeRule::FromParam("Axes")
}

/// Declares a motion along chunks: what a chunk states beside its rows, and what the arm reports.
macro_rules! chunks {
    (
        $(#[doc = $doc:expr])+
        $id:ident = $name:literal, $port:literal;
        rows { $( $row:ident : $ty:ty $( = $need:tt $( ( $($def:tt)+ ) )? )? );* }
    ) => {
        motion! {
            $(#[doc = $doc])+
            ///
            /// The in-ports up to those of the rows are read in the cycles in which `inNumber` changes to another number than 0:
            /// then a new chunk has come. The motion begins without a chunk, so the axes stop until the first one comes.
            ///
            /// A chunk has `inRows` rows, 4 to 200; the arrays may be longer. The first row has the time `inAge` (s) before
            /// now: rows whose time has passed are left out. If `inAppended` is true, the first row follows one period after
            /// the last one of the chunk before instead. Where the new chunk overlaps with the one before, the mean of both
            /// with the weight `inPreviousWeight` (0 to 0.95) of the one before is used; the first `inFrozenRows` rows are
            /// those of the one before.
            ///
            /// The rows are smoothed by least squares, as little as the limits of the axes demand and by at most `inSmoothing`
            /// (rad) at a row. The arm follows the resulting curve at the times of the rows, more slowly where a limit binds.
            /// It brakes on the curve and rests at the last row if no chunk comes, and goes on with the next one. The parts
            /// of its position, velocity and acceleration that a new chunk does not have decay within the limits of all axes,
            /// which hold in each cycle, for any chunk.
            ///
            /// `outAccepted` is the number of the newest accepted chunk, `outRow` (from 0) its row whose time has come, and
            /// `outRejected` the error code of the newest chunk if it was not accepted, else 0; the arm then follows the one
            /// before. `outDeviation` is the largest distance of an axis from the curve (rad), `outLag` the time by which the
            /// arm is behind the times of the rows (s), `outSmoothing` the largest deviation of the curve from its rows (rad),
            /// `outRemaining` the time until the last row (s). `outLate` is true while the arm brakes or rests because no
            /// chunk has come. `outAxis` (from 1) is an axis with a limit that binds, `outLimit` its kind: 1 velocity,
            /// 2 acceleration, 3 jerk, 4 range; both are 0 without one. `outDone` is true while the arm rests at the last row.
            /// `Axes` is the number of axes of the arm. The work grows with the number of rows.
            $id = $name, $port;
            in {
                inNumber: i64;
                inRows: i64;
                inPeriod: f64;
                inAge: f64 = Age(Real(0.0));
                inAppended: bool = Appended(Bool(false));
                inPreviousWeight: f64 = PreviousWeight(Real(0.0));
                inFrozenRows: i64 = FrozenRows(Int(0));
                inSmoothing: f64 = Smoothing(Real(0.01));
                $( $row: $ty $( = $need $( ( $($def)+ ) )? )? );*
            }
            param Axes;
            out {
                outAccepted: i64;
                outRow: i64;
                outDeviation: f64;
                outLag: f64;
                outSmoothing: f64;
                outRemaining: f64;
                outLate: bool;
                outAxis: i64;
                outLimit: i64;
                outRejected: i64
            }
            work 300;
            shape ShapeRule::FromParam("Axes")
        }
    };
}

chunks! {
    /// Motion of the axes along chunks: rows of joint positions, one `inPeriod` (0.01 to 0.1 s) after the other, that arrive
    /// again and again while the arm executes the last ones. `inPositions` (rad, m for a linear axis) and `inVelocities`
    /// (rad/s, m/s) have one number for each axis, row by row. Velocities are used if `inWithVelocities` is true.
    FOLLOW_CHUNKS = "Rpi::FollowChunks", "follow_chunks";
    rows {
        inWithVelocities: bool = WithVelocities(Bool(false));
        inPositions: Array<f64>;
        inVelocities: Array<f64>
    }
}

chunks! {
    /// Motion along chunks of poses of the tool in the base frame of the arm (`inPoses`), one `inPeriod` (0.01 to 0.1 s) after the
    /// other, that arrive again and again while the arm executes the last ones. The arm converts them to joint positions,
    /// each the nearest one to the row before, eight rows in a cycle, and interpolates these. A chunk with a pose that it
    /// cannot reach is not accepted.
    FOLLOW_POSE_CHUNKS = "Rpi::FollowPoseChunks", "follow_pose_chunks";
    rows { inPoses: Array<Pose> }
}

interface! {
    /// Next set-point of the axes for the pose `inTo` of the tool in the base frame of the arm, at the end of this cycle; it is
    /// read in each cycle. While the axes can keep their limits at the poses, `outPose` is `inTo`. Where they cannot, they follow
    /// as closely as their limits allow, and take up the poses again once they have caught up. The limits hold in each cycle, for
    /// any poses. If the arm cannot reach `inTo`, all axes come to rest, and `outError` is the error code; 0 otherwise. The
    /// primitive is no motion with a number: `inTo` may be computed from the pose of one. `Axes` is the number of axes of the arm.
    FOLLOW_POSE = "Rpi::FollowPose";
    in { inTo: Pose }
    param { Robot: Text = Str(""); Axes: i64 = Int(7) }
    out {
        outJoints: Array<f64>;
        outPose: Pose;
        outError: i64
    }
    shape ShapeRule::FromParam("Axes");
    presence strict work 20000;
    role function("Robot", &["follow_pose"])
}
