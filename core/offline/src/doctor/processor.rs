//! Processor and memory.

use super::Check;

/// Memory that calibration, disparity and the window need together, with room to spare.
const MEMORY_WANTED_BYTES: u64 = 2_000_000_000;

/// Instruction sets that make image processing fast.
pub(super) fn instructions() -> Check {
    const NAME: &str = "processor";
    let model = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| model_name(&text));
    let model = model.unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    match fast_instructions() {
        Some(true) => Check::good(NAME, format!("{model}, with AVX2")),
        Some(false) => Check::bad(
            NAME,
            format!("{model} lacks AVX2: everything works, but disparity takes several times as long"),
        ),
        None => Check::good(NAME, model),
    }
}

/// How much can run at once.
pub(super) fn cores() -> Check {
    const NAME: &str = "cores";
    match std::thread::available_parallelism() {
        Ok(count) if count.get() >= 2 => Check::good(NAME, format!("{count} for this program")),
        Ok(_) => Check::bad(
            NAME,
            "only one for this program: live disparity and the window take turns; give it two or more",
        ),
        Err(error) => Check::bad(NAME, format!("their number is not known ({error}); one is assumed")),
    }
}

/// Memory that is free for programs.
pub(super) fn memory() -> Check {
    const NAME: &str = "memory";
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let (Some(total), Some(free)) = (bytes(&text, "MemTotal"), bytes(&text, "MemAvailable")) else {
        return Check::bad(NAME, "how much there is cannot be read from /proc/meminfo");
    };
    let detail = format!("{} of {} GB free", gigabytes(free), gigabytes(total));
    if free >= MEMORY_WANTED_BYTES {
        Check::good(NAME, detail)
    } else {
        Check::bad(NAME, format!("{detail}: close other programs, 2 GB should be free"))
    }
}

/// `None` where the question makes no sense.
fn fast_instructions() -> Option<bool> {
    #[cfg(target_arch = "x86_64")]
    return Some(std::arch::is_x86_feature_detected!("avx2"));
    #[cfg(not(target_arch = "x86_64"))]
    None
}

fn model_name(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

fn bytes(meminfo: &str, key: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(':'))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

fn gigabytes(bytes: u64) -> String {
    format!("{:.1}", bytes as f64 / 1e9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kernel_is_read_right() {
        let meminfo = "MemTotal:       24517356 kB\nMemFree:         1000 kB\nMemAvailable:    2097152 kB\n";
        assert_eq!(bytes(meminfo, "MemAvailable"), Some(2_147_483_648));
        assert_eq!(bytes(meminfo, "MemTotal"), Some(25_105_772_544));
        assert_eq!(bytes(meminfo, "Mem"), None);
        assert_eq!(bytes("MemTotal: many kB", "MemTotal"), None);
        let cpuinfo = "processor\t: 0\nmodel name\t: AMD EPYC 9B14\nflags\t\t: fpu\n";
        assert_eq!(model_name(cpuinfo).as_deref(), Some("AMD EPYC 9B14"));
        assert_eq!(model_name("processor: 0"), None);
    }
}
