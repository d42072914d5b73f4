//! Options of the page that shows a run while it goes on.

use clap::Args;

/// Options of the page that shows a run while it goes on.
#[derive(Args, Debug)]
pub(crate) struct LiveViewArgs {
    /// Show the run in a browser while it goes on, and its recording afterwards, until the process is interrupted. The page is on this
    /// machine only, at this port; without a number at any free one.
    #[arg(
        long,
        value_name = "PORT",
        num_args = 0..=1,
        default_missing_value = "0",
        require_equals = true,
        help_heading = "Live viewers"
    )]
    pub(crate) view: Option<u16>,
    /// Do not open the page in a browser; its address is printed.
    #[arg(long, requires = "view", help_heading = "Live viewers")]
    pub(crate) no_open: bool,
}
