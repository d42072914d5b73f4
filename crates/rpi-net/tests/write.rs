//! A net that is formatted as text and parsed again is equal.

mod nets;

use rpi_diag::{FileId, Span};
use rpi_image::{Scalar, Type, Value};
use rpi_net::rpinet::{parse, write};
use rpi_net::{Input, Net, Origin};

/// Net without source locations, and with rotations rounded to 12 digits, since angles are exact only up to rounding.
fn comparable(mut net: Net) -> Net {
    let nowhere = Origin {
        span: Span::NONE,
        flow: None,
    };
    for node in &mut net.nodes {
        node.origin = nowhere.clone();
        node.params.iter_mut().for_each(round_rotation);
        for input in &mut node.inputs {
            if let Input::Const(value) = input {
                round_rotation(value);
            }
        }
    }
    for fragment in &mut net.fragments {
        fragment.origin = nowhere.clone();
    }
    net
}

fn round_rotation(value: &mut Value) {
    let Value::Slots {
        ty: Type::Scalar(scalar),
        cells,
    } = value
    else {
        return;
    };
    let from = match scalar {
        Scalar::Rotation => 0,
        Scalar::Pose => 3,
        _ => return,
    };
    for cell in &mut cells[from..] {
        *cell = ((f64::from_bits(*cell) * 1e12).round() / 1e12 + 0.0).to_bits();
    }
}

#[test]
fn every_recorded_net_reads_back_equal() {
    let Some(all) = nets::all() else { return };
    for (name, text) in &all {
        let first = nets::net(name, text);
        let written = write(&first);
        let second = nets::net(name, &written);
        assert!(
            comparable(first) == comparable(second),
            "{name}:\n{written}"
        );
    }
}

#[test]
fn texts_of_all_kinds_read_back_equal() {
    let text = "{a=Core::DoubleAdd(inFirst=Core::Clock(Increment='0.5').outValue,Second='-1.0E-7'),\
        k=Core::BooleanNetcommOut(Key='it\\'s \\\\ it's'),_1=Cancel(),\
        f={g={o=parent.i,p=Core::Clock()}(i=parent.j,rpi:restart='activation'),x=g.o}\
        (j=a.outValue,inActive=_1.outCancel,rpi:restart=_1.outCancel),outX=f.x,outTerminate=_1.outCancel}";
    let first = nets::net("kinds", text);
    let written = write(&first);
    assert_eq!(
        written,
        "{a=Core::DoubleAdd(inFirst=_2.outValue,Second='-1.0E-7'),_2=Core::Clock(Increment='0.5'),\
        k=Core::BooleanNetcommOut(Value='false',Key='it\\'s \\\\ it\\'s',Report='true'),_1=Cancel(),\
        f={g={p=Core::Clock(Increment='1.0'),o=parent.i}(i=parent.j,rpi:restart='activation'),x=parent.j}\
        (j=a.outValue,inActive=_1.outCancel,rpi:restart=_1.outCancel),outX=a.outValue,outTerminate=_1.outCancel}"
    );
    let second = nets::net("kinds", &written);
    assert!(comparable(first) == comparable(second));
}

#[test]
fn links_through_borders_get_ports() {
    let text = "{a=Core::Clock(),f={b=Core::DoubleAdd(),c={d=Core::DoubleAdd()}()}()}";
    let mut net = nets::net("borders", text);
    let port = |node: u32| rpi_net::PortRef {
        node: rpi_net::NodeId(node),
        port: 0,
    };
    net.nodes[2].inputs[0] = Input::Port(port(0));
    net.nodes[1].inputs[0] = Input::Port(port(2));
    let written = write(&net);
    assert_eq!(
        written,
        "{a=Core::Clock(Increment='1.0'),f={b=Core::DoubleAdd(inFirst=c.out0,Second='0.0'),\
        c={d=Core::DoubleAdd(inFirst=parent.in0,Second='0.0'),out0=d.outValue}(in0=parent.in0)}(in0=a.outValue)}"
    );
    assert!(parse("again", FileId(0), &written).0.is_some());
}
