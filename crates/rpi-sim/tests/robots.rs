//! Robot descriptions: built-in models, URDF, tables, and their errors.
//!
//! `RPI_POSES` sets the number of random poses for each model (default: a smoke for CI).

use rpi_kin::{InverseKinematics, Pose, models};
use rpi_sim::Cell;
use rpi_sim::robot::{
    FolderFiles, NoFiles, RobotDescription, RobotFileError, RobotFiles, RobotReport, builtin,
    builtin_ids, drawing,
};

fn poses() -> usize {
    std::env::var("RPI_POSES").map_or(2000, |text| text.parse().expect("a number"))
}

fn described(file: &str, text: &str) -> RobotDescription {
    RobotDescription::parse(file, text, &NoFiles).unwrap_or_else(|errors| panic!("{errors}"))
}

#[test]
fn built_in_files_give_the_tables_to_the_last_bit() {
    for table in models::ALL.iter().chain(&[&models::linear::LINEAR_UNIT]) {
        let file = builtin(table.id).unwrap_or_else(|| panic!("{} has no file", table.id));
        assert_eq!(file, *table);
    }
}

#[test]
fn every_built_in_model_reads_and_is_found_again() {
    assert!(builtin_ids().is_sorted());
    for id in builtin_ids() {
        let found = RobotDescription::open(id, &NoFiles).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(found.model.id, id);
        assert_eq!(found.axes.len(), found.model.axes());
        assert!(
            std::ptr::eq(found.model, builtin(id).expect("known")),
            "{id}"
        );
    }
}

/// Both directions on random poses, which joints within the ranges gave. A closed form finds all of them from any hint,
/// iterations 99.9 %.
#[test]
fn the_inverse_finds_random_poses() {
    for id in builtin_ids() {
        let found = RobotDescription::open(id, &NoFiles).expect("valid");
        let is_iterative = match found.model.inverse {
            InverseKinematics::NoClosedForm => continue,
            InverseKinematics::DampedLeastSquares { .. } => true,
            _ => false,
        };
        let report = RobotReport::new(&found, poses());
        println!("{report}");
        let tested = report.inverse;
        let lost = tested.poses - tested.found;
        let most = if is_iterative { tested.poses / 1000 } else { 0 };
        assert!(
            lost <= most,
            "{id}: {lost} of {} are not found",
            tested.poses
        );
        assert!(
            tested.distance < 1e-9 && tested.angle < 1e-9,
            "{id}: {tested:?}"
        );
    }
}

#[test]
fn forward_kinematics_follow_published_poses() {
    let Some(path) = rpi_testkit::external_data_path("golden/robots-and-profiles.json") else {
        return;
    };
    let text = std::fs::read_to_string(path).expect("readable");
    let golden: serde_json::Value = serde_json::from_str(&text).expect("valid JSON");
    let reals = |value: &serde_json::Value| -> Vec<f64> {
        let list = value.as_array().expect("a list").iter();
        list.map(|number| number.as_f64().expect("a number"))
            .collect()
    };
    let panda = builtin("franka-panda").expect("known");
    let cases = golden["fk_panda_link8_pilz"]["cases"]
        .as_array()
        .expect("cases");
    for case in cases {
        let pose = panda.forward(&reals(&case["q"]));
        let expected = nalgebra::Vector3::from_column_slice(&reals(&case["xyz"]));
        assert!((pose.translation.vector - expected).amax() < 1e-6);
    }
    assert_eq!(cases.len(), 4);
}

const SMALL: &str = r#"<robot name="two-axes">
  <link name="base"/> <link name="mount"/> <link name="upper"/> <link name="fore"/> <link name="tool0"/> <link name="finger"/>
  <joint name="standing" type="fixed">
    <parent link="base"/> <child link="mount"/> <origin xyz="0 0 0.5" rpy="0 0 1.5707963267948966"/>
  </joint>
  <joint name="shoulder" type="revolute">
    <parent link="mount"/> <child link="upper"/> <origin xyz="0.1 0 0"/> <axis xyz="0 -2 0"/>
    <limit lower="-1" upper="2" velocity="3" effort="1" acceleration="7"/>
  </joint>
  <joint name="slide" type="prismatic">
    <parent link="upper"/> <child link="fore"/> <origin xyz="0 0 0.3"/> <axis xyz="1 0 0"/>
    <limit lower="0" upper="0.4" velocity="1.5" effort="1"/>
  </joint>
  <joint name="end" type="fixed">
    <parent link="fore"/> <child link="tool0"/> <origin xyz="0.05 0 0"/>
  </joint>
  <joint name="grip" type="prismatic">
    <parent link="tool0"/> <child link="finger"/> <mimic joint="slide"/> <limit lower="0" upper="1" velocity="1" effort="1"/>
  </joint>
</robot>"#;

#[test]
fn a_urdf_gives_the_chain_of_its_transforms() {
    let found = described("small.urdf", SMALL);
    assert_eq!(found.axes, ["shoulder", "slide"]);
    let (turn, slide) = (0.4, 0.25);
    let z = |angle| Pose::rotation(nalgebra::Vector3::z() * angle);
    let expected = Pose::translation(0.0, 0.0, 0.5)
        * z(std::f64::consts::FRAC_PI_2)
        * Pose::translation(0.1, 0.0, 0.0)
        * Pose::rotation(nalgebra::Vector3::y() * -turn)
        * Pose::translation(slide, 0.0, 0.3)
        * Pose::translation(0.05, 0.0, 0.0);
    let pose = found.model.forward(&[turn, slide]);
    let off = (pose.to_homogeneous() - expected.to_homogeneous()).amax();
    assert!(off < 1e-15, "{pose} {expected}");
    let [shoulder, slide] = found.model.limits else {
        panic!("two axes")
    };
    assert_eq!((shoulder.position.lower, shoulder.velocity), (-1.0, 3.0));
    assert_eq!((shoulder.acceleration, shoulder.jerk), (7.0, 7.0 / 0.05));
    assert_eq!(
        (slide.acceleration, slide.jerk),
        (1.5 / 0.3, 1.5 / 0.3 / 0.05)
    );
    let assumed = [
        "acceleration (velocity / 0.3 s)",
        "jerk (acceleration / 0.05 s)",
    ];
    assert_eq!(found.assumed, assumed);
}

/// Some tools write names with a prefix that they do not declare. Drake's limit of the acceleration counts where there is
/// no other.
#[test]
fn undeclared_prefixes_do_not_matter_and_move_no_error() {
    let drake = "drake:acceleration=\"5\"";
    let text = SMALL.replace("velocity=\"3\"", &format!("{drake} velocity=\"3\""));
    let acceleration = |text: &str| described("r.urdf", text).model.limits[0].acceleration;
    assert_eq!(acceleration(&text), 7.0);
    assert_eq!(acceleration(&text.replace(" acceleration=\"7\"", "")), 5.0);
    let wrong = text.replace("upper=\"0.4\"", "upper=\"far\"");
    let errors = RobotDescription::parse("r.urdf", &wrong, &NoFiles).expect_err("wrong");
    let shown = errors.to_string();
    assert!(
        shown.starts_with("r.urdf:12:5: `upper` is \"far\""),
        "{shown}"
    );
}

/// Changes of the small URDF that make one error each, and a part of the message.
const URDF_ERRORS: &[(&str, &str, &str)] = &[
    ("</robot>", "", "invalid XML"),
    (
        "<axis xyz=\"0 -2 0\"/>",
        "<axis xyz=\"0 0 0\"/>",
        "has no direction",
    ),
    ("0 0 0.3", "0 0 ${h}", "expected three finite numbers"),
    ("lower=\"-1\"", "lower=\"nan\"", "expected a finite number"),
    ("lower=\"-1\"", "lower=\"5\"", "empty range"),
    ("velocity=\"3\"", "velocity=\"0\"", "no velocity limit"),
    (
        "<parent link=\"base\"/>",
        "<parent link=\"bas\"/>",
        "unknown link `bas`",
    ),
    (
        "<child link=\"mount\"/>",
        "<child link=\"fore\"/>",
        "child of two joints",
    ),
    (
        "<parent link=\"base\"/>",
        "<parent link=\"fore\"/>",
        "cycle",
    ),
    (
        "type=\"prismatic\"",
        "type=\"planar\"",
        "several degrees of freedom",
    ),
    ("type=\"revolute\"", "type=\"turning\"", "unknown type"),
    ("<robot name", "<sdf name", "invalid XML"),
];

const TABLE: &str = "name = \"r\"\n[dh]\nconvention = \"standard\"\njoints = [{ d = 1 }]\n";

/// Text after the small table, or in place of it if it has a name, with one error each, and a part of the message.
const TOML_ERRORS: &[(&str, &str)] = &[
    ("name = \"r\"\n", "kinematics are missing"),
    ("", "has no range"),
    ("[opw]\n", "cannot be combined"),
    (
        "[limits]\nlower = [1, 2]\nupper = 1\nvelocity = 1\n",
        "expected 1",
    ),
    ("[limit]\nlower = 1\n", "unknown key `limit`"),
    (
        "name = \"r\"\n[dh]\nconvention = \"standard\"\njoints = [{ sign = 2 }]\n",
        "expected 1 or -1",
    ),
    ("name = \"r\"\n[urdf]\nfile = \"x.urdf\"\n", "x.urdf"),
    (
        "name = \"r\"\n[dh]\nconvention = \"standard\"\n",
        "`joints` is missing",
    ),
];

fn must_fail(file: &str, text: &str, part: &str) {
    let errors = match RobotDescription::parse(file, text, &NoFiles) {
        Ok(found) => panic!("{part}: {found:?}"),
        Err(errors) => errors,
    };
    let shown = errors.to_string();
    assert!(shown.contains(part), "{part}:\n{shown}");
    assert!(shown.starts_with(&format!("{file}:")), "{shown}");
}

#[test]
fn errors_have_a_place_and_a_way_out() {
    for (old, new, part) in URDF_ERRORS {
        must_fail("r.urdf", &SMALL.replace(old, new), part);
    }
    must_fail("r.urdf", "<sdf/>", "expected <robot>");
    for (text, part) in TOML_ERRORS {
        let is_whole = text.starts_with("name");
        let table = if is_whole { "" } else { TABLE };
        must_fail("r.toml", &format!("{table}{text}"), part);
    }
}

/// Entities that multiply, deep nesting and files that are cut off are errors, in a short time.
#[test]
fn hostile_files_are_refused() {
    let bomb = format!(
        "<!DOCTYPE r [<!ENTITY a \"{}\">{}]><robot>&j;</robot>",
        "x".repeat(1000),
        ('b'..='j')
            .zip('a'..='i')
            .map(|(one, other)| format!("<!ENTITY {one} \"{}\">", format!("&{other};").repeat(10)))
            .collect::<String>()
    );
    let deep = format!(
        "{}{}",
        "<robot>".repeat(100_000),
        "</robot>".repeat(100_000)
    );
    for text in [bomb, deep] {
        assert!(RobotDescription::parse("r.urdf", &text, &NoFiles).is_err());
    }
    for end in (0..SMALL.len()).step_by(7) {
        assert!(RobotDescription::parse("r.urdf", &SMALL[..end], &NoFiles).is_err());
    }
}

struct OneFile;

impl RobotFiles for OneFile {
    fn read(&self, path: &str) -> Result<String, RobotFileError> {
        match path {
            "robots/small.urdf" => Ok(SMALL.to_owned()),
            "robots/small.toml" => {
                Ok("name = \"small\"\n[urdf]\nfile = \"small.urdf\"\ntip = \"fore\"\n".to_owned())
            }
            _ => Err(RobotFileError::new(path, "not there")),
        }
    }
}

#[test]
fn a_cell_names_a_file_and_carries_it_in_recordings() {
    let text = "[devices.left]\nkind = \"arm\"\nmodel = \"robots/small.toml\"\njoints = [\"10 deg\", \"200 mm\"]\n";
    let cell = Cell::parse_with("cell.toml", text, &OneFile).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(cell.robot_files.len(), 2);
    let whole = cell.self_contained(text);
    let again = Cell::parse("cell.toml", &whole).unwrap_or_else(|e| panic!("{e}\n{whole}"));
    assert_eq!(again.devices, cell.devices);
    assert_eq!(again.self_contained(&whole), whole);

    let errors = Cell::parse("cell.toml", text)
        .expect_err("no files here")
        .to_string();
    assert!(
        errors.contains("cell.toml:3:9: robots/small.toml"),
        "{errors}"
    );
    let wrong = text.replace("200 mm", "200 deg");
    let errors = Cell::parse_with("cell.toml", &wrong, &OneFile).expect_err("wrong unit");
    assert!(
        errors.to_string().contains("not a valid number"),
        "{errors}"
    );
}

#[test]
fn a_drawing_shows_every_joint() {
    let found = RobotDescription::open("ur5e", &NoFiles).expect("valid");
    let svg = drawing(&found);
    // Base, six links and flange, in two views.
    assert_eq!(svg.matches("<circle").count(), 2 * 8);
    assert!(!svg.contains("NaN"), "{svg}");
}

/// URDF files of another project, from a package of the Python index: `pip install --target target/urdf airo-models`.
#[test]
fn a_urdf_of_another_project_agrees_with_our_table() {
    let path = rpi_testkit::workspace_root().join("target/urdf/airo_models/arms");
    if !path.exists() {
        rpi_testkit::report_skip(
            "target/urdf is missing: pip install --target target/urdf airo-models",
        );
        return;
    }
    for id in ["ur3e", "ur5e"] {
        let file = path.join(format!("{id}/{id}.urdf"));
        let name = format!("{id}.urdf");
        let found = RobotDescription::open(&name, &FolderFiles::beside(&file));
        let found = found.unwrap_or_else(|errors| panic!("{errors}"));
        let table = builtin(id).expect("known");
        // The URDF counts x of its base the other way round, and ends at the same flange.
        let base = Pose::rotation(nalgebra::Vector3::z() * std::f64::consts::PI);
        for round in 0..100 {
            let joints: [f64; 6] = std::array::from_fn(|axis| {
                f64::from((round * (axis as i32 + 3) * 7) % 41 - 20) / 7.0
            });
            let [one, other] = [base * table.forward(&joints), found.model.forward(&joints)];
            let off = (one.translation.vector - other.translation.vector).norm();
            assert!(off < 1e-5, "{id}: {one} {other}");
        }
        assert!(!found.meshes.is_empty());
    }
}
