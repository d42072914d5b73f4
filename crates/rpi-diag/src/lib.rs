//! Findings: the one table of codes, their pages, and how they are shown.
