//! Nets for the tests, in the notation of the reference system.

/// Moves axis `axis` of the arm back and forth by 0.1 rad for ever. Exports the set-point as `probe`, and true as `_1`
/// after `seconds`.
pub(crate) fn swing(axis: usize, seconds: f64) -> String {
    format!(
        "{{clock=Core::Clock(Increment='1.0'),\
         cos=Core::DoubleCos(inValue=clock.outValue),\
         less=Core::DoubleMultiply(inFirst=cos.outValue,Second='-0.1'),\
         at=Core::DoubleAdd(inFirst=less.outValue,Second='0.1'),\
         axis=RobotArm::JointPosition(inPosition=at.outValue,Robot='arm',Axis='{axis}'),\
         after=Core::DoubleGreater(inFirst=clock.outValue,Second='{seconds}'),\
         probe=Core::DoubleNetcommOut(inValue=at.outValue,Key='probe'),\
         done=Core::BooleanNetcommOut(inValue=after.outValue,Key='_1')}}"
    )
}

/// Moves axis 0 as [`swing`] does. Exports `blend` after `seconds`, and after a second `completed`, or `cancelled` if
/// it was.
#[allow(dead_code, reason = "the tests of bad clients use the others")]
pub(crate) fn way(seconds: f64) -> String {
    let results = format!(
        ",c=Cancel(),n=Core::BooleanNot(inValue=c.outCancel),\
         d=Core::DoubleGreater(inFirst=clock.outValue,Second='1.0'),\
         b=Core::DoubleGreater(inFirst=clock.outValue,Second='{seconds}'),\
         nd=Core::BooleanAnd(inFirst=n.outValue,inSecond=d.outValue),\
         cd=Core::BooleanAnd(inFirst=d.outValue,inSecond=c.outCancel),\
         x1=Core::BooleanNetcommOut(inValue=nd.outValue,Key='completed'),\
         x2=Core::BooleanNetcommOut(inValue=cd.outValue,Key='cancelled'),\
         x3=Core::BooleanNetcommOut(inValue=b.outValue,Key='blend')}}"
    );
    let swing = swing(0, seconds);
    swing.trim_end_matches('}').to_owned() + &results
}

/// Holds axis `axis` at its commanded position.
pub(crate) fn hold(axis: usize) -> String {
    format!(
        "{{m=RobotArm::JointMonitor(Robot='arm',Axis='{axis}'),\
         axis=RobotArm::JointPosition(inPosition=m.outCommandedPosition,Robot='arm',Axis='{axis}'),\
         t=Core::BooleanValue(Value='true'),\
         done=Core::BooleanNetcommOut(inValue=t.outValue,Key='_1')}}"
    )
}

/// Exports twice its input `gain` as `twice`, and whether it was cancelled.
pub(crate) const ECHO: &str = "{in=Core::DoubleNetcommIn(Key='gain',Value='1.0'),\
    two=Core::DoubleMultiply(inFirst=in.outValue,Second='2.0'),\
    out=Core::DoubleNetcommOut(inValue=two.outValue,Key='twice'),\
    c=Cancel(),stop=Core::BooleanNetcommOut(inValue=c.outCancel,Key='cancelled')}";
