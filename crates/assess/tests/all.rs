//! Every file of this folder is a module of one program: a program of its own costs more to link than most files take to run.

mod araim;
mod flights;
mod fused;
mod led_off;
mod plausible;
mod raim;
mod smoothing;
