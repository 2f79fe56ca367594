"""From a declaration to code: functions, steps, Jacobians, sensitivities, compiled records, typeset equations."""
