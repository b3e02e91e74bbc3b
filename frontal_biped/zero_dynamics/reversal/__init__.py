"""The reversal point beta_r-: bracket, scalar problem, solver, the planned point, all zeros, certificate."""
