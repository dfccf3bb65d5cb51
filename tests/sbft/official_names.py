"""The public names of the SBFT tool competition's pipeline, as generators can import them.

Facts, read from its code of November 2024, and none of that code. Classes and functions are given with their
parameters, constants and attributes without; names that begin with an underscore are left out. Modules that
only drive BeamNG or a network are in ``ELSEWHERE``.
"""

NAMES = {
    "code_pipeline.beamng_executor": """
        FloatDTuple
        BeamngExecutor(result_folder,map_size,time_budget,oob_tolerance,max_speed_in_kmh,beamng_home,beamng_user)
        BeamngExecutor.end_iteration() BeamngExecutor.beamng_home BeamngExecutor.beamng_user
        BeamngExecutor.brewer BeamngExecutor.last_observation BeamngExecutor.max_speed_in_ms
        BeamngExecutor.min_delta_position BeamngExecutor.oob_tolerance BeamngExecutor.risk_value
        BeamngExecutor.road_visualizer BeamngExecutor.vehicle
    """,
    "code_pipeline.executors": """
        Budget(time_budget) Budget.start() Budget.get_start_time() Budget.get_remaining_time()
        Budget.get_remaining_real_time() Budget.can_run_a_test() Budget.is_over() Budget.start_real_time
        Budget.time_budget AbstractTestExecutor.start_time
        AbstractTestExecutor(result_folder,map_size,time_budget,road_visualizer,debug)
        AbstractTestExecutor.is_force_timeout() AbstractTestExecutor.store_test(the_test)
        AbstractTestExecutor.execute_test(the_test) AbstractTestExecutor.validate_test(the_test)
        AbstractTestExecutor.get_stats() AbstractTestExecutor.close() AbstractTestExecutor.is_over()
        AbstractTestExecutor.get_remaining_time() AbstractTestExecutor.debug
        AbstractTestExecutor.result_folder AbstractTestExecutor.road_visualizer
        AbstractTestExecutor.start_generation_time AbstractTestExecutor.stats
        AbstractTestExecutor.test_validator AbstractTestExecutor.time_budget
        AbstractTestExecutor.timeout_forced MockExecutor
    """,
    "code_pipeline.test_analysis": """
        THE_NORTH get_thetas(xs,ys,skip) direction_coverage_klk(the_test,n_bins)
        direction_coverage(the_test,n_bins) max_curvature(the_test,w) sd_steering(execution_data)
        mean_lateral_position(execution_data) max_lateral_position(execution_data)
        compute_all_features(the_test,execution_data)
    """,
    "code_pipeline.test_generation_utils": """
        register_exit_fun(fun,signals,logfun)
    """,
    "code_pipeline.tests_evaluation": """
        BEFORE_THRESHOLD AFTER_THRESHOLD RoadTestEvaluator(road_length_before_oob,road_length_after_oob)
        RoadTestEvaluator.identify_interesting_road_segments(road_nodes,execution_data)
        RoadTestEvaluator.road_length_after_oob RoadTestEvaluator.road_length_before_oob
        OOBAnalyzer(result_folder,road_length_before_oob,road_length_after_oob) OOBAnalyzer.create_summary()
        OOBAnalyzer.create_oob_report() OOBAnalyzer.logger OOBAnalyzer.oobs
    """,
    "code_pipeline.tests_generation": """
        rounding_precision interpolation_distance smoothness min_num_nodes RoadTestFactory
        RoadTestFactory.test_id_generator RoadTestFactory.RoadTest(road_points)
        RoadTestFactory.RoadTest.get_road_polygon()
        RoadTestFactory.RoadTest.get_road_length(interpolate_road_points)
        RoadTestFactory.RoadTest.set_validity(is_valid,validation_message)
        RoadTestFactory.RoadTest.to_json() RoadTestFactory.RoadTest.interpolated_points
        RoadTestFactory.RoadTest.is_valid RoadTestFactory.RoadTest.road_points
        RoadTestFactory.RoadTest.road_polygon RoadTestFactory.RoadTest.validation_message
        RoadTestFactory.create_road_test(road_points) TestGenerationStatistic()
        TestGenerationStatistic.as_csv() TestGenerationStatistic.obes
        TestGenerationStatistic.test_execution_real_times
        TestGenerationStatistic.test_execution_simulation_times TestGenerationStatistic.test_failed
        TestGenerationStatistic.test_generated TestGenerationStatistic.test_generation_real_times
        TestGenerationStatistic.test_in_error TestGenerationStatistic.test_invalid
        TestGenerationStatistic.test_passed TestGenerationStatistic.test_valid
    """,
    "code_pipeline.utils": """
        pairwise(iterable)
    """,
    "code_pipeline.validation": """
        find_circle(p1,p2,p3) min_radius(x,w) TestValidator(map_size,min_road_length)
        TestValidator.is_enough_road_points(the_test) TestValidator.is_too_many_points(the_test)
        TestValidator.is_not_self_intersecting(the_test) TestValidator.is_too_sharp(the_test,TSHD_RADIUS)
        TestValidator.is_inside_map(the_test) TestValidator.is_right_type(the_test)
        TestValidator.is_valid_polygon(the_test) TestValidator.intersects_boundary(the_test)
        TestValidator.is_minimum_length(the_test) TestValidator.validate_test(the_test) TestValidator.box
        TestValidator.map_size TestValidator.max_points TestValidator.min_road_length
        TestValidator.road_bbox
    """,
    "code_pipeline.visualization": """
        RoadTestVisualizer.little_triangle RoadTestVisualizer.square RoadTestVisualizer(map_size)
        RoadTestVisualizer.visualize_road_test(the_test) RoadTestVisualizer.last_submitted_test_figure
        RoadTestVisualizer.map_size
    """,
    "self_driving.bbox": """
        RoadBoundingBox(bbox_size) RoadBoundingBox.intersects_sides(point)
        RoadBoundingBox.intersects_vertices(point) RoadBoundingBox.intersects_boundary(other)
        RoadBoundingBox.contains(other) RoadBoundingBox.get_sides() RoadBoundingBox.get_vertices()
        RoadBoundingBox.bbox
    """,
    "self_driving.beamng_pose": """
        BeamNGPose(pos,rot) BeamNGPose.pos BeamNGPose.rot
    """,
    "self_driving.beamng_road_imagery": """
        BeamNGRoadImagery(road_points) BeamNGRoadImagery.plot() BeamNGRoadImagery.save(image_path)
        BeamNGRoadImagery.from_sample_nodes(sample_nodes) BeamNGRoadImagery.road_points
    """,
    "self_driving.beamng_waypoint": """
        BeamNGWaypoint(name,position,persistentId) BeamNGWaypoint.to_json() BeamNGWaypoint.name
        BeamNGWaypoint.persistentId BeamNGWaypoint.position
    """,
    "self_driving.decal_road": """
        DecalRoad.DEFAULT_MATERIAL DecalRoad(name,material,persistentId,drivability)
        DecalRoad.add_4d_points(nodes) DecalRoad.to_dict() DecalRoad.from_dict(d) DecalRoad.to_json()
        DecalRoad.drivability DecalRoad.material DecalRoad.name DecalRoad.nodes DecalRoad.persistentId
    """,
    "self_driving.edit_distance_polyline": """
        AngleLength ListOfAngleLength Point ListOfPoints iterative_levenshtein(s,t)
    """,
    "self_driving.oob_monitor": """
        OutOfBoundsMonitor(road_polygon,vehicle_state_reader,tolerance)
        OutOfBoundsMonitor.get_oob_info(wrt,oob_bb) OutOfBoundsMonitor.update_oob_counter(is_oob)
        OutOfBoundsMonitor.update_oob_percentage(is_oob) OutOfBoundsMonitor.oob_percentage(wrt)
        OutOfBoundsMonitor.is_oob_bb(wrt) OutOfBoundsMonitor.oob_distance(wrt)
        OutOfBoundsMonitor.is_oob(wrt) OutOfBoundsMonitor.last_is_oob
        OutOfBoundsMonitor.last_max_oob_percentage OutOfBoundsMonitor.oob_counter
        OutOfBoundsMonitor.road_polygon OutOfBoundsMonitor.tolerance OutOfBoundsMonitor.vehicle_state_reader
    """,
    "self_driving.road_points": """
        List4DTuple List2DTuple RoadPoints.from_nodes(middle_nodes) RoadPoints()
        RoadPoints.add_middle_nodes(middle_nodes) RoadPoints.calc_point_edges(p1,p2)
        RoadPoints.angle_to_quat(angle)
        RoadPoints.vehicle_start_pose(meters_from_road_start,road_point_index) RoadPoints.new_imagery()
        RoadPoints.plot_on_ax(ax) RoadPoints.left RoadPoints.middle RoadPoints.n RoadPoints.right
    """,
    "self_driving.road_polygon": """
        RoadPolygon.from_nodes(nodes) RoadPolygon(road_points) RoadPolygon.is_valid()
        RoadPolygon.left_polygon RoadPolygon.left_polyline RoadPolygon.num_polygons RoadPolygon.polygon
        RoadPolygon.polygons RoadPolygon.polyline RoadPolygon.right_polygon RoadPolygon.right_polyline
        RoadPolygon.road_points RoadPolygon.road_width
    """,
    "self_driving.simulation_data": """
        SimulationDataRecordProperties SimulationDataRecord SimulationDataRecords SimulationParams
        delete_folder_recursively(path) SimulationInfo SimulationData.f_info SimulationData.f_params
        SimulationData.f_road SimulationData.f_records SimulationData(simulation_name) SimulationData.n
        SimulationData.set(params,road,states,info) SimulationData.clean() SimulationData.save()
        SimulationData.load() SimulationData.complete() SimulationData.min_oob_distance()
        SimulationData.start() SimulationData.end(success,exception) SimulationData.exception_str
        SimulationData.id SimulationData.info SimulationData.name SimulationData.params
        SimulationData.path_json SimulationData.path_partial SimulationData.path_road_img
        SimulationData.path_root SimulationData.road SimulationData.simulations SimulationData.states
    """,
    "self_driving.utils": """
        get_node_coords(node) points_distance(p1,p2)
    """,
    "self_driving.vehicle_state_reader": """
        VehicleStateProperties VehicleState
    """,
}

ELSEWHERE = (
    "code_pipeline.dave2_executor",
    "self_driving.beamng_brewer",
    "self_driving.beamng_car_cameras",
    "self_driving.beamng_tig_maps",
    "self_driving.image_processing",
    "self_driving.nvidia_prediction",
    "self_driving.simulation_data_collector",
)
