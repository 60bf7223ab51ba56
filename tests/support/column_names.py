"""Names of columns as loggers, drivers and controllers write them; ``*`` is the joint.

Written from drivers and loggers of the field, not from the reader: ros2_control and
PlotJuggler topics, libfranka, UR's RTDE, Dynamixel, ODrive, CANopen drives, the fields
of this arm's own protocol, simulators, identification and Kalman filters.
"""

#: None of these is a measured joint position in radians.
NOT_POSITIONS = """
tau_*|tau*|Tau_*|TAU_*|tau.*|/tau/*|tau_alpha_*|alpha_tau_*|*_tau|*.tau
torque_*|torques_*|*_torque|joint_torque_*|jointTorque_*|measured_torque_*
applied_torque_*|*_torque_nm|* [Nm]|*_Nm
tau_J_*|tau_J_d_*|tau_ext_hat_filtered_*|tau_ext_*|tau_g_*|tau_fric_*|tau_cmd_*
cmd_tau_*|taucmd_*|tau_measured_*
effort_*|*_effort|efforts_*|effort/*|*/effort|/joint_states/*/effort
/joint_states/effort/*|eff_*|*_eff|left_effort_*
current_*|*_current|currents_*|motor_current_*|*_motor_current|i_*|I_*|iq_*|Iq_setpoint_*|iq_measured_*
id_*|*_amps|amps_*|*_mA|*_milliamps|present_current_*|actual_current_*|target_current_*|current_axis/*|cur_*
voltage_*|*_voltage|v_*|V_*|vbus_*|supply_voltage_*|present_input_voltage_*|*_volts|u_*|U_*
power_*|*_power|p_*|watts_*|*_W|electrical_power_*|energy_*|*_energy|mechanical_power_*|*_electrical_power
temp_*|*_temp|temperature_*|*_temperature|motor_temp_*|*_temp_C|internal_temperature_*|T_*|joint_temperatures_*|t_*
vel_*|*_vel|velocity_*|*_velocity|velocities_*|dq_*|qd_*|qdot_*|q_dot_*|dq_alpha_*
dtheta_*|thetadot_*|theta_dot_*|omega_*|w_*|speed_*|*_speed|*_rpm|rpm_*|/joint_states/*/velocity
acc_*|*_acc|accel_*|acceleration_*|ddq_*|qdd_*|qddot_*|ddq_alpha_*|jerk_*|*_acceleration
cmd_*|*_cmd|command_*|*_command|commanded_*|cmd_q_*|q_cmd_*|cmd_pos_*|*_pos_cmd|cmd_vel_*
des_*|*_des|desired_*|q_des_*|q_d_*|dq_d_*|*_desired|desired_pos_*|*_position_desired|qdes_*
ref_*|*_ref|ref_alpha_*|dref_alpha_*|ddref_alpha_*|arm_ref_*|arm_dref_*|q_alpha_*_ref|q_ref_*|reference_*
target_*|target_q_*|*_target|goal_*|goal_position_*|setpoint_*|*_setpoint|sp_*|*_sp|input_*
err_*|*_err|error_*|*_error|e_*|pos_err_*|q_err_*|*_pos_err|following_error_*|tracking_error_*
/arm_controller/state/error/positions/*|/arm_controller/state/desired/positions/*|/joint_commands/*/position|residual_*|innovation_*|delta_*|dpos_*|*_delta|deltaq_*|diff_*
std_*|*_std|sigma_*|*_sigma|var_*|*_var|cov_*|P_*|*_covariance|std_pos_*
min_*|max_*|*_min|*_max|lower_*|upper_*|limit_*|*_limit|position_limit_*|margin_*
kp_*|ki_*|kd_*|*_kp|gain_*|pid_output_*|integral_*|ff_*|feedforward_*|kp_pos_*
pwm_*|*_pwm|duty_*|*_duty|openloop_*|*_openloop|ctrl_*|control_output_*|joint_control_output_*|throttle_*
encoder_*|*_counts|counts_*|raw_*|*_raw|ticks_*|shadow_count_*|adc_*|motor_pos_*|rotor_angle_*
status_*|*_status|mode_*|*_mode|fault_*|error_code_*|flags_*|enabled_*|is_homed_*|hardware_error_status_*
stamp_*|*_stamp|timestamp_*|*_time|age_*|delay_*|latency_*|dt_*|seq_*|count_*
load_*|*_load|present_load_*|force_*|*_force|wrench_*|moment_*|strain_*|mom_*|F_*
humidity_*|internal_humidity_*|pressure_*|leak_*|depth_*|friction_*|gravity_*|coriolis_*|inertia_*|buoyancy_*
deg_*|angle_deg_*|deg_*_pos|*_vel_deg|*_deg_cmd|mass_*|drag_*|weight_*|foo_*
τ_*|ω_*|Δ_*|σ_*|dq*|*'|*_dot|-*|*²|qpos_err_*
"""

#: These are measured joint positions in radians, with what stands before the joints.
POSITIONS = {
    "*": "",
    "*_pos": "",
    "*_position": "",
    "q_*": "",
    "theta_*": "",
    "pos_*": "",
    "*_q": "",
    "left_*": "left_",
    "left_*_pos": "left_",
    "alpha/*": "alpha/",
    "arm_2/*_position": "arm_2/",
    "q_alpha_*": "alpha_",
    "alpha_q_*": "alpha_",
    "jointPosition_*": "joint",
    "/joint_states/*/position": "/joint_states/",
    "actual_position_*": "actual_",
    "*_measured_pos": "",
    "q_meas_*": "meas_",
    "my_robot_*_pos": "my_robot_",
}


def not_positions() -> list[str]:
    """The names, each with ``*`` for the joint."""
    return [
        name for line in NOT_POSITIONS.split("\n") if line for name in line.split("|")
    ]
