//! `plumbline bench`.

use clap::Args;

use super::output::Output;

/// Arguments of `bench`.
#[derive(Debug, Args)]
pub struct Bench {}

/// Measures.
pub fn run(_arguments: Bench, _output: &Output) -> anyhow::Result<()> {
    anyhow::bail!("not yet")
}
