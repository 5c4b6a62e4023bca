//! Every file of this folder is a module of one program: a program of its own costs more to link than most files take to run.

mod algorithms;
mod architecture;
mod closed_forms;
mod common;
mod contract;
mod judge;
mod judge_bytes;
mod limits;
mod properties_anp;
mod properties_dme;
mod properties_tse;
mod rnp_exposure;
mod rnp_monitor;
mod rnp_monitor_bytes;
mod rnp_monitor_rules;
