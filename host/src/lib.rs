//! The pendulum rig on the PC.
