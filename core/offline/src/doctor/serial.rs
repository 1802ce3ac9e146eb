//! Serial ports of USB adapters, over which servos are reached.

use std::fs::Metadata;
use std::os::unix::fs::{FileTypeExt, MetadataExt};
use std::path::Path;

use super::Check;

/// One check for all, and one for each port.
pub(super) fn ports() -> Vec<Check> {
    ports_in(Path::new("/dev"), &User::current())
}

fn ports_in(folder: &Path, user: &User) -> Vec<Check> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| name.starts_with("ttyUSB") || name.starts_with("ttyACM"))
        .collect();
    names.sort_by(|a, b| plumbline_hardware::natural_order(a, b));
    let summary = match names.len() {
        0 => Check::bad("serial ports", "none found; needed for the robot's motors only, not for its eyes"),
        count => Check::good("serial ports", format!("{count} found")),
    };
    std::iter::once(summary).chain(names.iter().map(|name| port(&folder.join(name), name, user))).collect()
}

fn port(path: &Path, name: &str, user: &User) -> Check {
    let name = format!("serial port {name}");
    match std::fs::metadata(path) {
        Err(error) => Check::bad(name, format!("cannot be looked at ({error}); plug the adapter in again")),
        Ok(found) if !found.file_type().is_char_device() => {
            Check::bad(name, format!("{} is no serial port; remove it", path.display()))
        }
        Ok(found) if user.may_read_and_write(&found) => {
            Check::good(name, format!("{} can be used", path.display()))
        }
        Ok(_) => Check::bad(
            name,
            format!(
                "you may not use {}; add yourself to the group dialout (sudo usermod -aG dialout $USER) and log in again",
                path.display()
            ),
        ),
    }
}

/// Who this program runs as.
struct User {
    user_id: u32,
    group_ids: Vec<u32>,
}

impl User {
    fn current() -> Self {
        Self::from_status(&std::fs::read_to_string("/proc/self/status").unwrap_or_default())
    }

    /// From /proc/self/status: real, effective, saved and file system id of user and group,
    /// and the further groups. Someone unknown has no rights but those of everybody.
    fn from_status(status: &str) -> Self {
        let ids = |key: &str| -> Vec<u32> {
            let line = status.lines().find_map(|line| line.strip_prefix(key)).unwrap_or_default();
            line.split_whitespace().filter_map(|id| id.parse().ok()).collect()
        };
        let mut group_ids = ids("Groups:");
        group_ids.extend(ids("Gid:").get(1));
        Self { user_id: ids("Uid:").get(1).copied().unwrap_or(u32::MAX), group_ids }
    }

    fn may_read_and_write(&self, file: &Metadata) -> bool {
        let mode = file.mode();
        // The first class that fits decides, even if a later one has more rights.
        let rights = if self.user_id == 0 {
            return true;
        } else if self.user_id == file.uid() {
            mode >> 6
        } else if self.group_ids.contains(&file.gid()) {
            mode >> 3
        } else {
            mode
        };
        rights & 0o6 == 0o6
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn the_kernel_is_read_right() {
        let status =
            "Name:\tplumbline\nUid:\t1000\t1001\t1000\t1000\nGid:\t100\t101\t100\t100\nGroups:\t20 44 \n";
        let user = User::from_status(status);
        assert_eq!((user.user_id, user.group_ids), (1001, vec![20, 44, 101]));
        assert_eq!(User::from_status("").user_id, u32::MAX);
    }

    #[test]
    fn rights_follow_owner_group_and_others() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("port");
        fs::write(&path, "").expect("writing");
        let file = |mode: u32| {
            fs::set_permissions(&path, fs::Permissions::from_mode(mode)).expect("own file");
            fs::metadata(&path).expect("it is there")
        };
        let (owner, group) = (file(0o600).uid(), file(0o600).gid());
        let stranger = |group_ids: Vec<u32>| User { user_id: owner.wrapping_add(77), group_ids };
        assert!(!stranger(vec![]).may_read_and_write(&file(0o660)));
        assert!(stranger(vec![5, group]).may_read_and_write(&file(0o660)));
        assert!(!stranger(vec![group]).may_read_and_write(&file(0o646)), "reading alone is not enough");
        assert!(stranger(vec![]).may_read_and_write(&file(0o606)));
        assert!(User { user_id: 0, group_ids: vec![] }.may_read_and_write(&file(0o000)));
    }

    #[test]
    fn ports_are_told_in_order_and_what_is_none_is_told_too() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let user = User::current();
        assert!(!ports_in(folder.path(), &user)[0].ok);
        for name in ["ttyUSB10", "ttyUSB2", "ttyACM0", "tty1"] {
            fs::write(folder.path().join(name), "").expect("writing");
        }
        let checks = ports_in(folder.path(), &user);
        let names: Vec<&str> = checks.iter().map(|check| check.name.as_str()).collect();
        assert_eq!(
            names,
            ["serial ports", "serial port ttyACM0", "serial port ttyUSB2", "serial port ttyUSB10"]
        );
        assert!(checks[1].detail.contains("is no serial port"), "a plain file is none: {checks:?}");
    }
}
