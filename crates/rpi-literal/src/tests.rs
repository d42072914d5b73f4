use super::*;
use rpi_prims::value_types::Rotation;

/// Scalar types with texts that are written back unchanged after parsing.
const SAME: &[(Scalar, &[&str])] = &[
    (Scalar::Bool, &["true", "false"]),
    (Scalar::Int, &["0", "-7", "9223372036854775807"]),
    (
        Scalar::Real,
        &[
            "-1.0E-5",
            "nan",
            "+inf",
            "-inf",
            "-0.0",
            "0.1",
            "1.7976931348623157E308",
        ],
    ),
    (Scalar::Time, &["1795223516581", "-1", "5.25", "-0.5"]),
    (Scalar::Vector, &["{x:1.0,y:-2.5,z:nan}"]),
    (Scalar::Rotation, &["{a:0.0,b:-0.0,c:0.0}"]),
    (
        Scalar::Pose,
        &["{pos:{x:1.0,y:2.0,z:3.0},rot:{a:0.0,b:-0.0,c:0.0}}"],
    ),
    (
        Scalar::Twist,
        &["{vel:{x:1.0,y:2.0,z:3.0},rot:{x:4.0,y:5.0,z:6.0}}"],
    ),
    (
        Scalar::Wrench,
        &["{force:{x:1.0,y:2.0,z:3.0},torque:{x:4.0,y:5.0,z:6.0}}"],
    ),
];

#[test]
fn texts_read_and_write_back() {
    for (scalar, texts) in SAME {
        for text in *texts {
            let value = parse_scalar(text, *scalar).unwrap().unwrap();
            assert_eq!(write(value.slots(), Type::Scalar(*scalar)), *text);
        }
    }
}

#[test]
fn what_is_too_large_for_a_real_is_not_infinite() {
    let read = |text: &str| parse_scalar(text, Scalar::Real);
    for text in ["1e400", "-1e400"] {
        let why = read(text).unwrap_err().to_string();
        assert!(why.contains("that a real can hold, or inf"), "{why}");
    }
    let vector = "{x:1e400,y:0,z:0}";
    assert!(parse_scalar(vector, Scalar::Vector).is_err());
    for text in ["inf", "-inf", "Infinity", "1e308", "1e-400"] {
        assert!(read(text).is_ok(), "{text}");
    }
}

#[test]
fn rotations_are_turns_about_z_then_y_then_x() {
    let rotation = |text| {
        Rotation::load(
            parse_scalar(text, Scalar::Rotation)
                .unwrap()
                .unwrap()
                .slots(),
            0,
        )
    };
    let turns = ["{a:0.3,b:0,c:0}", "{a:0,b:-0.4,c:0}", "{a:0,b:0,c:0.5}"].map(rotation);
    let all = rotation("{a:0.3,b:-0.4,c:0.5}");
    assert!(all.angle_to(&(turns[0] * turns[1] * turns[2])) < 1e-15);
    let axes = turns.map(|t| t.axis().unwrap().into_inner());
    assert_eq!(
        axes.map(|a| [a.x, a.y, a.z]),
        [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]]
    );
}

#[test]
fn fields_may_come_in_any_order() {
    let value = parse_scalar("{ z: 3, x: 1, y: 2 }", Scalar::Vector)
        .unwrap()
        .unwrap();
    assert_eq!(
        write(value.slots(), Scalar::Vector.into()),
        "{x:1.0,y:2.0,z:3.0}"
    );
}

#[test]
fn null_is_absence() {
    assert_eq!(parse_scalar("null", Scalar::Pose), Ok(None));
    assert_eq!(parse("[1.0,null]", Type::Array(Scalar::Real, 2)), Ok(None));
    let elements = parse_array("[true,null]", Scalar::Bool, 2)
        .unwrap()
        .unwrap();
    assert_eq!(elements, [Some(Value::bool(true)), None]);
}

#[test]
fn arrays_have_the_length_of_their_type() {
    let value = parse("[1, 2,3 ]", Type::Array(Scalar::Int, 3))
        .unwrap()
        .unwrap();
    assert_eq!(value.slots(), [1, 2, 3]);
    assert!(parse("[1,2]", Type::Array(Scalar::Int, 3)).is_err());
    assert_eq!(parse_array("[]", Scalar::Int, 0).unwrap().unwrap(), []);
}

#[test]
fn an_array_of_any_type_may_be_as_long_as_its_type_says() {
    for (scalar, texts) in SAME {
        let text = format!("[{}]", vec![texts[0]; 100].join(","));
        let value = parse(&text, Type::Array(*scalar, 100)).unwrap();
        assert!(value.is_some(), "{text}");
    }
}

/// The tree of a text takes many times the memory of the text, so it is not made for more elements than expected.
#[test]
fn a_text_with_far_too_many_elements_is_not_read_to_its_end() {
    let text = format!("[{}1]", "1,".repeat(1_000_000));
    for error in [
        parse(&text, Type::Array(Scalar::Real, 100)).unwrap_err(),
        parse_scalar(&text, Scalar::Real).unwrap_err(),
        parse_array(&text, Scalar::Real, 100).unwrap_err(),
    ] {
        assert_eq!(error.message, "too many elements");
        assert!(error.offset < 2000, "{}", error.offset);
    }
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let error = |text, scalar| parse_scalar(text, scalar).unwrap_err();
    assert_eq!(
        error("maybe", Scalar::Bool).message,
        "expected true or false"
    );
    assert_eq!(
        error("{x:1,y:2}", Scalar::Vector).message,
        "expected {x:..,y:..,z:..}"
    );
    assert_eq!(error("{x:1,y:2,z:}", Scalar::Vector).offset, 11);
    assert_eq!(error("1.5 2", Scalar::Real).offset, 4);
    assert_eq!(error("", Scalar::Real).message, "expected a value");
    assert!(
        error(&"[".repeat(1000), Scalar::Real)
            .message
            .contains("deep")
    );
}

#[test]
fn no_prefix_of_a_value_makes_it_panic() {
    for (scalar, texts) in SAME {
        for text in texts.iter().chain(["[1,{ä:2}]", "{a", "9.é"].iter()) {
            for end in (0..=text.len()).filter(|&k| text.is_char_boundary(k)) {
                let _ = parse_scalar(&text[..end], *scalar);
                let _ = parse_array(&text[..end], *scalar, end);
            }
        }
    }
}
