//! Rigs of robots that were only measured.

use std::path::PathBuf;

use super::*;

/// An arm with a continuous first joint, a joint without limits, a gripper that slides, a mesh and
/// a link with a mass that is no mass.
const ARM: &str = r#"<?xml version="1.0"?>
<robot name="two_axes">
  <link name="base"><visual><geometry><mesh filename="package://none/base.stl"/></geometry></visual></link>
  <joint name="turn" type="continuous">
    <origin xyz="0 0 0.3"/><axis xyz="0 0 1"/><parent link="base"/><child link="upper"/>
  </joint>
  <link name="upper"/>
  <joint name="lift" type="revolute">
    <origin xyz="0 0 0.1"/><axis xyz="0 0.6 0.8"/><parent link="upper"/><child link="fore"/>
  </joint>
  <link name="fore">
    <inertial><mass value="-1"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>
  </link>
  <joint name="grip" type="prismatic">
    <origin xyz="0.4 0 0"/><axis xyz="0 1 0"/><limit lower="0" upper="0.04" effort="1" velocity="1"/>
    <parent link="fore"/><child link="flange"/>
  </joint>
  <link name="flange"/>
</robot>"#;

fn folder(files: &[(&str, &str)]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("writable");
    }
    let path = folder.path().to_path_buf();
    (folder, path)
}

#[test]
fn a_bare_description_is_a_rig_of_a_measured_robot() {
    let (_keep, folder) = folder(&[("arm.urdf", ARM)]);
    let rig = Rig::read_measured(&folder.join("arm.urdf")).expect("a description is enough");
    assert_eq!(rig.name, "two_axes");
    assert_eq!(rig.description.movable_count(), 2);
    assert_eq!(rig.description.held_kind("grip"), Some("prismatic"));
    assert_eq!(rig.description.held_kind("lift"), None);
    for part in [RigPart::Servos, RigPart::Eyes, RigPart::Gate, RigPart::Limits, RigPart::Masses] {
        assert!(!rig.has(part), "{part:?}");
        let refused = rig.need(part).expect_err("lacking").to_string();
        assert!(refused.contains(part.title()) && refused.contains("two_axes"), "{refused}");
    }
    let chain = rig.chain("flange").expect("the last link");
    let place = chain.robot_from_tip(&[std::f64::consts::FRAC_PI_2, 0.0]).translation_m();
    assert!((place - nalgebra::Vector3::new(0.0, 0.4, 0.4)).norm() < 1e-12, "{place}");
    // Read strictly, the same is refused.
    assert!(Description::from_urdf(ARM).is_err());
}

#[test]
fn a_rig_file_may_say_little() {
    let files = [
        "name = \"lab arm\"\ndescription = \"arm.urdf\"\n",
        "name = \"lab arm\"\nurdf = \"arm.urdf\"\nsomething = 3\n",
        "format = 1\nname = \"lab arm\"\n[robot]\nfile = \"arm.urdf\"\n",
        "name = \"lab arm\"\n",
    ];
    for text in files {
        let (_keep, folder) = folder(&[("arm.urdf", ARM), ("rig.toml", text)]);
        let rig = Rig::read_measured(&folder.join("rig.toml")).expect("readable");
        assert_eq!(rig.name, "lab arm", "{text}");
        assert_eq!(rig.description.movable_count(), 2);
        assert!(Rig::read(&folder.join("rig.toml")).is_err(), "it is no complete rig");
    }
}

#[test]
fn what_is_given_is_read_and_checked() {
    let table = "name = \"a\"\ndescription = \"arm.urdf\"\n\
        [[arm]]\nname = \"only\"\ntitle = \"Arm\"\njoints = [\"turn\", \"lift\"]\nhand = []\n\
        [[arm.tip]]\nlink = \"flange\"\ntitle = \"Flange\"\n";
    let (_keep, good) = folder(&[("arm.urdf", ARM), ("rig.toml", table)]);
    let rig = Rig::read_measured(&good.join("rig.toml")).expect("readable");
    assert!(rig.has(RigPart::Arms) && rig.arms[0].tips[0].link == "flange");
    let wrong = table.replace("flange", "nothing");
    let (_keep, bad) = folder(&[("arm.urdf", ARM), ("rig.toml", &wrong)]);
    assert!(matches!(Rig::read_measured(&bad.join("rig.toml")), Err(RigError::Unknown { .. })));
}

#[test]
fn without_a_description_it_says_what_to_add() {
    let (_keep, folder) = folder(&[("rig.toml", "name = \"a\"\n")]);
    let error = Rig::read_measured(&folder.join("rig.toml")).expect_err("nothing to read");
    assert!(error.to_string().contains("description"), "{error}");
    let gone = Rig::read_measured(&folder.join("gone.toml")).expect_err("no file");
    assert!(matches!(gone, RigError::File(_)));
}

#[test]
fn a_complete_rig_file_is_read_strictly() {
    let (_keep, folder) = folder(&[
        ("nico.urdf", include_str!("../../../../assets/robots/nico/nico.urdf")),
        ("rig.toml", include_str!("../../../../assets/robots/nico/rig.toml")),
        ("bad.toml", &include_str!("../../../../assets/robots/nico/rig.toml").replace("baud = ", "bauds = ")),
    ]);
    let rig = Rig::read_measured(&folder.join("rig.toml")).expect("complete");
    assert_eq!(rig, Rig::built_in("nico").expect("comes along"));
    assert!(rig.lacking.is_empty());
    assert!(Rig::read_measured(&folder.join("bad.toml")).is_err(), "a wrong key is not passed over");
}
